//! The page's files, all within the program.

use std::borrow::Cow;

/// Kind and body of a file of the page, by its path.
pub fn find(path: &str) -> Option<(&'static str, Cow<'static, str>)> {
    const SCRIPT: &str = "text/javascript";
    Some(match path {
        "/" => ("text/html", include_str!("../page/index.html").into()),
        "/theme.css" => ("text/css", sixaxis_page::theme().ok()?.into()),
        "/panel.css" => ("text/css", include_str!("../page/panel.css").into()),
        "/axis.js" => (SCRIPT, sixaxis_page::AXIS_SCRIPT.into()),
        "/chart.js" => (SCRIPT, include_str!("../page/chart.js").into()),
        "/panel.js" => (SCRIPT, include_str!("../page/panel.js").into()),
        "/day.js" => (SCRIPT, include_str!("../page/day.js").into()),
        "/cube.js" => (SCRIPT, include_str!("../page/cube.js").into()),
        "/spectrum.js" => (SCRIPT, include_str!("../page/spectrum.js").into()),
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inv_the_page_loads_nothing_from_elsewhere() {
        let (_, page) = find("/").expect("a page");
        for part in page
            .split(['"', '\''])
            .filter(|part| part.starts_with('/') && part.len() > 1)
        {
            assert!(find(part).is_some(), "{part}");
        }
        for path in [
            "/",
            "/theme.css",
            "/panel.css",
            "/axis.js",
            "/chart.js",
            "/panel.js",
            "/day.js",
            "/cube.js",
            "/spectrum.js",
        ] {
            let (_, body) = find(path).expect(path);
            let foreign = body.replace("http://www.w3.org/2000/svg", "");
            assert!(
                !foreign.contains("http://") && !foreign.contains("https://"),
                "{path}"
            );
            // Names from data are text and never markup.
            assert!(
                !body.contains("innerHTML")
                    && !body.contains("outerHTML")
                    && !body.contains("insertAdjacentHTML"),
                "{path}"
            );
        }
    }

    #[test]
    fn inv_the_theme_is_that_of_the_reports() {
        let (_, theme) = find("/theme.css").expect("a theme");
        for part in [
            "--paper: #fdfdfc",
            "--paper: #15171a",
            "--s7:",
            "data-theme=\"dark\"",
        ] {
            assert!(theme.contains(part), "{part}");
        }
        assert!(!theme.contains("{%"));
    }
}
