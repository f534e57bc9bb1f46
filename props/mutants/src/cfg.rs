//! Whether an item is in the program that is tested: `#[cfg]` as it holds there.

use syn::punctuated::Punctuated;
use syn::{Attribute, Expr, ExprLit, Lit, Meta, Token};

/// Features of core that are on in the test programs.
const FEATURES: [&str; 2] = ["std", "alloc"];

/// Whether all `#[cfg]` of these attributes hold. `test` does not: tests are not mutated.
pub fn holds(attributes: &[Attribute]) -> bool {
    attributes
        .iter()
        .filter(|a| a.path().is_ident("cfg"))
        .all(|a| a.parse_args::<Meta>().is_ok_and(|meta| predicate(&meta)))
}

fn predicate(meta: &Meta) -> bool {
    match meta {
        Meta::Path(_) => meta.path().is_ident("unix"),
        Meta::List(list) => {
            let parts = list
                .parse_args_with(Punctuated::<Meta, Token![,]>::parse_terminated)
                .unwrap_or_default();
            let mut parts = parts.iter().map(predicate);
            if list.path.is_ident("not") {
                !parts.all(|x| x)
            } else if list.path.is_ident("any") {
                parts.any(|x| x)
            } else {
                parts.all(|x| x)
            }
        }
        Meta::NameValue(pair) => {
            let Expr::Lit(ExprLit {
                lit: Lit::Str(value),
                ..
            }) = &pair.value
            else {
                return false;
            };
            let value = value.value();
            if pair.path.is_ident("feature") {
                FEATURES.contains(&value.as_str())
            } else {
                pair.path.is_ident("target_arch") && value == std::env::consts::ARCH
            }
        }
    }
}
