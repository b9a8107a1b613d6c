//! Redraws the figures of a page from the table in its directory, without runs.

use super::page::{PageFigure, stem, write_figures};
use super::{Artifact, ReproduceError, ReproduceOptions};
use rodlab_files::figure::Format;
use rodlab_files::results::{ResultsError, write_whole};
use std::fs;
use std::path::PathBuf;

/// Draws the figures of an artefact again, and sets their captions; returns the written files.
///
/// # Errors
/// [`ReproduceError::NotRedrawn`] if its figures need more data than its table contains,
/// [`ReproduceError::NoTable`] if the table is missing, or an error if results cannot be read or
/// written.
pub fn redraw(
    artifact: &'static Artifact,
    options: &ReproduceOptions,
) -> Result<Vec<PathBuf>, ReproduceError> {
    let name = artifact.name();
    let directory = options.directory.join(name);
    let table = directory.join(format!("{}.csv", stem(name)));
    let figures = match artifact.recipe.redrawn(&table) {
        None => return Err(ReproduceError::NotRedrawn { artifact: name }),
        Some(_) if !table.exists() => {
            return Err(ReproduceError::NoTable {
                artifact: name,
                table,
            });
        }
        Some(figures) => figures?,
    };
    let mut written = Vec::new();
    for figure in &figures {
        written.extend(write_figures(&directory, figure, &options.figures)?);
    }
    let page = directory.join("README.md");
    if options.figures.formats.contains(&Format::Svg) && page.exists() {
        let text = fs::read_to_string(&page).map_err(ResultsError::io("read", &page))?;
        let with_captions = figures.iter().fold(text, with_caption);
        write_whole(&page, with_captions.as_bytes())?;
        written.push(page);
    }
    Ok(written)
}

/// A page with the new caption of a figure.
fn with_caption(page: String, figure: &PageFigure) -> String {
    let shown = format!("]({}.svg)", figure.name);
    if !page.contains(&shown) {
        return format!("{}\n\n{}\n", page.trim_end(), figure.in_markdown("svg"));
    }
    let mut text = String::with_capacity(page.len());
    let mut is_below = false;
    for paragraph in page.trim_end().split("\n\n") {
        if !text.is_empty() {
            text += "\n\n";
        }
        let is_picture = paragraph.starts_with("![") && paragraph.ends_with(&shown);
        if is_picture {
            text += &figure.in_markdown("svg");
        } else if is_below && paragraph.starts_with('*') && paragraph.ends_with('*') {
            // The caption was already written with its picture.
            text.truncate(text.len() - 2);
        } else {
            text += paragraph;
        }
        is_below = is_picture;
    }
    text + "\n"
}

#[cfg(test)]
mod tests {
    use super::*;
    use rodlab_files::figure::line_plots;

    #[test]
    fn captions_are_set_and_the_rest_of_the_page_stays() {
        let figure = PageFigure {
            name: "fig".into(),
            caption: "New words".into(),
            figure: line_plots([], "x"),
        };
        let page = "# Title\n\n![Old](fig.svg)\n\n*Old*\n\n| a |\n| - |\n\n![Other](fig_2.svg)\n\n*Other*\n";
        let expected = page.replace("Old", "New words");
        assert_eq!(with_caption(page.into(), &figure), expected);
        assert_eq!(with_caption(expected.clone(), &figure), expected);
        let without = "# Title\n".to_owned();
        let added = "# Title\n\n![New words](fig.svg)\n\n*New words*\n";
        assert_eq!(with_caption(without, &figure), added);
    }
}
