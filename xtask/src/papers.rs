//! Collects the citations of the code into the tables of `docs/papers`.
//!
//! A citation is a line of a doc comment below the heading `# Reference`:
//! `[Key] Eq. (11), §6. Deviation: what is done differently.` Keys are those of
//! `docs/bibliography.bib`; `docs/papers/papers.toml` lists the equations and algorithms of the
//! papers that have a page of their own, so that a table also shows what nothing claims.

mod citation;
mod contents;
mod table;

use std::collections::BTreeSet;

use citation::Citation;
use contents::Paper;

use crate::tree::{self, File};

/// Bibliography in BibTeX.
const BIBLIOGRAPHY: &str = "docs/bibliography.bib";
/// What the papers with a page of their own contain.
const CONTENTS: &str = "docs/papers/papers.toml";
/// Page of all other sources.
const OTHERS: &str = "docs/papers/README.md";

/// Arguments of `cargo xtask papers`.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// Change nothing; fail if a table is stale or a citation is unknown.
    #[arg(long)]
    check: bool,
}

/// Writes or checks the tables.
pub(crate) fn run(args: &Args) -> Result<(), String> {
    if args.check {
        return check();
    }
    let files = tree::read(&tree::root())?;
    for page in current_pages(&files)? {
        tree::write(&page)?;
        println!("wrote {}", page.path);
    }
    Ok(())
}

/// Fails if a table is stale or a citation is unknown.
pub(crate) fn check() -> Result<(), String> {
    let files = tree::read(&tree::root())?;
    let pages = current_pages(&files)?;
    let is_stale = |page: &&File| {
        !files
            .iter()
            .any(|f| f.path == page.path && f.text == page.text)
    };
    let stale: Vec<_> = pages
        .iter()
        .filter(is_stale)
        .map(|page| page.path.as_str())
        .collect();
    if stale.is_empty() {
        println!("ok     {} pages agree with the code", pages.len());
        return Ok(());
    }
    Err(format!(
        "{} no longer agree with the code: run `cargo xtask papers`",
        stale.join(", ")
    ))
}

/// Returns the pages as the code's citations would have them.
fn current_pages(files: &[File]) -> Result<Vec<File>, String> {
    let keys = contents::bibliography_keys(&text_of(files, BIBLIOGRAPHY)?);
    let papers = contents::read(&text_of(files, CONTENTS)?)?;
    let citations: Vec<Citation> = files.iter().flat_map(citation::collect).collect();
    let errors = unknown(&citations, &keys, &papers);
    if !errors.is_empty() {
        return Err(errors.join("\n"));
    }
    let mut pages = Vec::new();
    for paper in &papers {
        let path = format!("docs/papers/{}.md", paper.page);
        let own = citations
            .iter()
            .filter(|c| c.key == paper.key)
            .collect::<Vec<_>>();
        let text = table::replace(&text_of(files, &path)?, &table::of_paper(paper, &own))
            .ok_or_else(|| format!("{path} has no {} and {}", table::BEGIN, table::END))?;
        pages.push(File { path, text });
    }
    let others = citations
        .iter()
        .filter(|c| papers.iter().all(|p| p.key != c.key))
        .collect::<Vec<_>>();
    let text = table::replace(&text_of(files, OTHERS)?, &table::of_others(&others))
        .ok_or_else(|| format!("{OTHERS} has no {} and {}", table::BEGIN, table::END))?;
    pages.push(File {
        path: OTHERS.to_owned(),
        text,
    });
    Ok(pages)
}

/// Returns a line for every citation of an unknown source or of an item its paper does not have.
fn unknown(citations: &[Citation], keys: &BTreeSet<String>, papers: &[Paper]) -> Vec<String> {
    let mut errors = Vec::new();
    for citation in citations {
        let place = format!("{}:{}", citation.path, citation.line);
        if !keys.contains(&citation.key) {
            errors.push(format!(
                "{place}: [{}] is not in {BIBLIOGRAPHY}",
                citation.key
            ));
        }
        let Some(paper) = papers.iter().find(|p| p.key == citation.key) else {
            continue;
        };
        for item in citation.items.iter().filter(|item| paper.lacks(item)) {
            errors.push(format!(
                "{place}: [{}] has no {item} in {CONTENTS}",
                citation.key
            ));
        }
    }
    for paper in papers.iter().filter(|p| !keys.contains(&p.key)) {
        errors.push(format!(
            "{CONTENTS}: [{}] is not in {BIBLIOGRAPHY}",
            paper.key
        ));
    }
    errors
}

fn text_of(files: &[File], path: &str) -> Result<String, String> {
    let file = files.iter().find(|file| file.path == path);
    file.map(|file| file.text.clone())
        .ok_or_else(|| format!("{path} is missing"))
}

#[cfg(test)]
mod tests {
    use super::{BIBLIOGRAPHY, CONTENTS, OTHERS, current_pages};
    use crate::tree::File;

    const CODE: &str = "\
/// Fits.
///
/// # Reference
/// [Hou2017] Eq. (2), §6. Deviation: faster.
/// [Meyer2003] §3.3.
pub fn fit() {}
";

    fn project(code: &str) -> Vec<File> {
        let contents = "[[paper]]\nkey = \"Hou2017\"\npage = \"hou2017\"\n\
            [[paper.item]]\nid = \"Eq. (1)\"\nwhat = \"one\"\n\
            [[paper.item]]\nid = \"Eq. (2)\"\nwhat = \"two\"\n";
        let page = "# Page\n<!-- citations:begin -->\n<!-- citations:end -->\nBy hand.\n";
        vec![
            File::new("crates/x/src/fit.rs", code),
            File::new(
                BIBLIOGRAPHY,
                "@article{Hou2017,\n}\n@incollection{Meyer2003,\n}\n",
            ),
            File::new(CONTENTS, contents),
            File::new("docs/papers/hou2017.md", page),
            File::new(OTHERS, page),
        ]
    }

    #[test]
    fn a_citation_lands_in_the_table_of_its_paper() -> Result<(), String> {
        let pages = current_pages(&project(CODE))?;
        assert!(
            pages[0].text.contains(
                "| Eq. (2) | two | [`x::fit::fit`](../../crates/x/src/fit.rs) | faster. |"
            )
        );
        assert!(pages[0].text.contains("Nothing claims Eq. (1)."));
        assert!(pages[0].text.ends_with("By hand.\n"));
        assert!(pages[1].text.contains("Meyer2003"));
        Ok(())
    }

    #[test]
    fn a_source_or_an_equation_that_does_not_exist_is_an_error() {
        let error = |code| current_pages(&project(code)).err().unwrap_or_default();
        assert!(
            error("/// # Reference\n/// [Nobody1999] Eq. (1).\nfn f() {}").contains("Nobody1999")
        );
        assert!(error("/// # Reference\n/// [Hou2017] Eq. (3).\nfn f() {}").contains("Eq. (3)"));
    }
}
