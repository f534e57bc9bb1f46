//! Every place of a crate that can be changed, and what it can be changed to.

use std::fs;
use std::ops::Range;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use syn::spanned::Spanned;
use syn::visit::{self, Visit};
use syn::{Attribute, BinOp, Block, Expr, ImplItem, Item, ReturnType, Signature, Stmt, UnOp};

use crate::{cfg, operators};

/// One change to a source file.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Mutant {
    /// Below the workspace's folder.
    pub file: PathBuf,
    /// In the file as it is, from one.
    pub line: usize,
    /// From one.
    pub column: usize,
    /// Function, with its type.
    pub function: String,
    /// In words.
    pub what: String,
    /// Bytes of the expression that is written twice; empty where a return is put in.
    pub site: Range<usize>,
    /// Bytes of it that differ.
    pub edit: Range<usize>,
    /// What they become.
    pub text: String,
    /// The `const` of the function it is in: a choice at run time asks for its removal.
    pub const_fn: Option<Range<usize>>,
    /// In a constant or static, which is worked out before there is anything to choose by.
    pub constant: bool,
}

impl Mutant {
    /// What it is drawn by.
    pub fn name(&self) -> String {
        let Self {
            file,
            line,
            column,
            function,
            what,
            ..
        } = self;
        format!("{}:{line}:{column}: {what} in {function}", file.display())
    }
}

/// All of a crate's, following its modules from lib.rs. `root` is the workspace, `library` its lib.rs below it.
pub fn of_crate(root: &Path, library: &Path) -> Vec<Mutant> {
    let mut found = Vec::new();
    of_file(root, library, true, &mut found);
    found
}

fn of_file(root: &Path, file: &Path, owns_folder: bool, found: &mut Vec<Mutant>) {
    let source =
        fs::read_to_string(root.join(file)).unwrap_or_else(|e| panic!("{}: {e}", file.display()));
    let tree = syn::parse_file(&source).unwrap_or_else(|e| panic!("{}: {e}", file.display()));
    let mut finder = Finder {
        source: &source,
        file,
        function: Vec::new(),
        own_type: String::new(),
        const_fn: None,
        constant: false,
        found,
    };
    finder.visit_file(&tree);
    let folder = if owns_folder {
        file.parent().unwrap_or(file).to_owned()
    } else {
        file.with_extension("")
    };
    for item in &tree.items {
        if let Item::Mod(module) = item
            && module.content.is_none()
            && cfg::holds(&module.attrs)
        {
            let name = module.ident.to_string();
            let flat = folder.join(&name).with_extension("rs");
            if root.join(&flat).is_file() {
                of_file(root, &flat, false, found);
            } else {
                of_file(root, &folder.join(name).join("mod.rs"), true, found);
            }
        }
    }
}

struct Finder<'a> {
    source: &'a str,
    file: &'a Path,
    function: Vec<String>,
    own_type: String,
    const_fn: Option<Range<usize>>,
    constant: bool,
    found: &'a mut Vec<Mutant>,
}

impl Finder<'_> {
    fn text(&self, node: &impl Spanned) -> &str {
        &self.source[node.span().byte_range()]
    }

    fn add(
        &mut self,
        at: proc_macro2::LineColumn,
        site: Range<usize>,
        edit: Range<usize>,
        text: String,
        what: String,
    ) {
        self.found.push(Mutant {
            file: self.file.to_owned(),
            line: at.line,
            column: at.column + 1,
            function: self.function.join("::"),
            what,
            site,
            edit,
            text,
            const_fn: self.const_fn.clone(),
            constant: self.constant,
        });
    }

    /// `node` within `site` becomes `text`.
    fn replace(&mut self, site: &impl Spanned, node: &impl Spanned, text: &str) {
        let new = if text.is_empty() { "nothing" } else { text };
        let what = format!("{} to {}", shortened(self.text(node)), shortened(new));
        let (span, site) = (node.span(), site.span().byte_range());
        self.add(span.start(), site, span.byte_range(), text.to_owned(), what);
    }

    fn function(&mut self, signature: &Signature, block: &Block, visit: impl FnOnce(&mut Self)) {
        self.function.push(signature.ident.to_string());
        let outer = self.const_fn.take();
        self.const_fn = signature.constness.map(|c| c.span().byte_range());
        if !block.stmts.is_empty() && signature.ident != "default" {
            self.bodies(signature, block);
        }
        visit(self);
        self.const_fn = outer;
        self.function.pop();
    }

    fn bodies(&mut self, signature: &Signature, block: &Block) {
        let output = match &signature.output {
            ReturnType::Default => None,
            ReturnType::Type(_, output) => Some(&**output),
        };
        let mut values = operators::bodies(output);
        if let Some(output) = output {
            let output = self.text(output);
            let same = |text: &str| text == output || (text == self.own_type && output == "Self");
            values.extend(signature.inputs.iter().find_map(|input| {
                match input {
                    syn::FnArg::Receiver(me) => (me.reference.is_none()
                        && (output == "Self" || output == self.own_type))
                        .then(|| "self".to_owned()),
                    syn::FnArg::Typed(typed) => match &*typed.pat {
                        syn::Pat::Ident(name) if same(self.text(&typed.ty)) => {
                            Some(name.ident.to_string())
                        }
                        _ => None,
                    },
                }
            }));
        }
        let at = block.brace_token.span.open();
        let begin = at.byte_range().end;
        for value in values {
            let what = format!("body to {}", if value.is_empty() { "()" } else { &value });
            let text = format!("return {value};");
            self.add(at.start(), begin..begin, begin..begin, text, what);
        }
    }

    fn constant(&mut self, visit: impl FnOnce(&mut Self)) {
        let outer = std::mem::replace(&mut self.constant, true);
        visit(self);
        self.constant = outer;
    }
}

/// On one line, and not for ever.
fn shortened(text: &str) -> String {
    let line = text.split_whitespace().collect::<Vec<_>>().join(" ");
    if line.chars().count() <= 40 {
        return line;
    }
    line.chars().take(37).chain("...".chars()).collect()
}

/// Whether a condition has a `let` that a parenthesis would take its meaning.
fn has_let(expr: &Expr) -> bool {
    match expr {
        Expr::Let(_) => true,
        Expr::Binary(both) if matches!(both.op, BinOp::And(_)) => {
            has_let(&both.left) || has_let(&both.right)
        }
        _ => false,
    }
}

fn attributes(item: &Item) -> &[Attribute] {
    match item {
        Item::Const(x) => &x.attrs,
        Item::Fn(x) => &x.attrs,
        Item::Impl(x) => &x.attrs,
        Item::Mod(x) => &x.attrs,
        Item::Static(x) => &x.attrs,
        Item::Trait(x) => &x.attrs,
        _ => &[],
    }
}

fn attributes_of_expression(expr: &Expr) -> &[Attribute] {
    match expr {
        Expr::Binary(x) => &x.attrs,
        Expr::Block(x) => &x.attrs,
        Expr::Call(x) => &x.attrs,
        Expr::If(x) => &x.attrs,
        Expr::MethodCall(x) => &x.attrs,
        Expr::Return(x) => &x.attrs,
        _ => &[],
    }
}

impl<'ast> Visit<'ast> for Finder<'_> {
    fn visit_item(&mut self, item: &'ast Item) {
        if cfg::holds(attributes(item)) {
            visit::visit_item(self, item);
        }
    }

    fn visit_impl_item(&mut self, item: &'ast ImplItem) {
        let attributes: &[Attribute] = match item {
            ImplItem::Const(x) => &x.attrs,
            ImplItem::Fn(x) => &x.attrs,
            _ => &[],
        };
        if cfg::holds(attributes) {
            visit::visit_impl_item(self, item);
        }
    }

    fn visit_stmt(&mut self, statement: &'ast Stmt) {
        let attributes = match statement {
            Stmt::Local(x) => &x.attrs,
            Stmt::Expr(x, _) => attributes_of_expression(x),
            _ => &[],
        };
        if cfg::holds(attributes) {
            visit::visit_stmt(self, statement);
        }
    }

    fn visit_item_impl(&mut self, item: &'ast syn::ItemImpl) {
        // What is printed for who debugs is no result.
        if let Some((_, of, _)) = &item.trait_
            && of.segments.last().is_some_and(|s| s.ident == "Debug")
        {
            return;
        }
        let name = self.text(&item.self_ty).to_owned();
        self.function.push(shortened(&name));
        let outer = std::mem::replace(&mut self.own_type, name);
        visit::visit_item_impl(self, item);
        self.own_type = outer;
        self.function.pop();
    }

    fn visit_item_trait(&mut self, item: &'ast syn::ItemTrait) {
        self.function.push(item.ident.to_string());
        visit::visit_item_trait(self, item);
        self.function.pop();
    }

    fn visit_item_fn(&mut self, item: &'ast syn::ItemFn) {
        self.function(&item.sig, &item.block, |this| {
            visit::visit_item_fn(this, item);
        });
    }

    fn visit_impl_item_fn(&mut self, item: &'ast syn::ImplItemFn) {
        self.function(&item.sig, &item.block, |this| {
            visit::visit_impl_item_fn(this, item);
        });
    }

    fn visit_trait_item_fn(&mut self, item: &'ast syn::TraitItemFn) {
        if let Some(block) = &item.default {
            self.function(&item.sig, block, |this| {
                visit::visit_trait_item_fn(this, item);
            });
        }
    }

    fn visit_item_const(&mut self, item: &'ast syn::ItemConst) {
        self.function.push(item.ident.to_string());
        self.constant(|this| visit::visit_item_const(this, item));
        self.function.pop();
    }

    fn visit_item_static(&mut self, item: &'ast syn::ItemStatic) {
        self.constant(|this| visit::visit_item_static(this, item));
    }

    fn visit_impl_item_const(&mut self, item: &'ast syn::ImplItemConst) {
        self.constant(|this| visit::visit_impl_item_const(this, item));
    }

    fn visit_trait_item_const(&mut self, item: &'ast syn::TraitItemConst) {
        self.constant(|this| visit::visit_trait_item_const(this, item));
    }

    fn visit_expr_const(&mut self, item: &'ast syn::ExprConst) {
        self.constant(|this| visit::visit_expr_const(this, item));
    }

    // What is no expression at run time.
    fn visit_attribute(&mut self, _: &'ast Attribute) {}
    fn visit_pat(&mut self, _: &'ast syn::Pat) {}
    fn visit_type(&mut self, _: &'ast syn::Type) {}
    fn visit_path_arguments(&mut self, _: &'ast syn::PathArguments) {}
    fn visit_angle_bracketed_generic_arguments(
        &mut self,
        _: &'ast syn::AngleBracketedGenericArguments,
    ) {
    }
    fn visit_generics(&mut self, _: &'ast syn::Generics) {}
    fn visit_item_enum(&mut self, _: &'ast syn::ItemEnum) {}
    fn visit_expr_repeat(&mut self, repeat: &'ast syn::ExprRepeat) {
        self.visit_expr(&repeat.expr);
    }

    fn visit_arm(&mut self, arm: &'ast syn::Arm) {
        if !cfg::holds(&arm.attrs) {
            return;
        }
        if let Some((_, guard)) = &arm.guard
            && !has_let(guard)
        {
            self.replace(guard, guard, "true");
            self.replace(guard, guard, "false");
        }
        visit::visit_arm(self, arm);
    }

    fn visit_expr(&mut self, expr: &'ast Expr) {
        match expr {
            Expr::Binary(both) if !has_let(expr) => {
                for other in operators::binary(&both.op) {
                    self.replace(expr, &both.op, other);
                }
            }
            Expr::Unary(one) if matches!(one.op, UnOp::Neg(_) | UnOp::Not(_)) => {
                self.replace(expr, &one.op, "");
                // The sign is changed already.
                if let Expr::Lit(lit) = &*one.expr {
                    let text = self.text(lit).to_owned();
                    for other in operators::literal(&lit.lit, &text) {
                        if !other.starts_with("(-") {
                            self.replace(expr, lit, &other);
                        }
                    }
                    return;
                }
            }
            Expr::Lit(lit) => {
                let text = self.text(lit).to_owned();
                for other in operators::literal(&lit.lit, &text) {
                    self.replace(expr, lit, &other);
                }
            }
            _ => {}
        }
        visit::visit_expr(self, expr);
    }
}
