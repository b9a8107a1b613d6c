//! The files of an artefact: CSV, Markdown, figures, and a manifest of their origin.

use super::ReproduceOptions;
use super::cases::{Case, Run};
use super::prose::wrapped;
use rodlab_files::figure::{Figure, FigureOptions};
use rodlab_files::origin::{VERSION, commit};
use rodlab_files::results::{CaseStatus, MANIFEST, ResultsError, check_own, write_whole};
use rodlab_lab::report::write_figure;
use rodlab_lab::run::thread_pools::threads_of_a_job;
use serde::Serialize;
use std::collections::VecDeque;
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// Name and title of a page.
#[derive(Clone, Copy)]
pub(super) struct Heading {
    /// Name of the artefact, for commands, directories and files.
    pub name: &'static str,
    /// Title with its number.
    pub title: &'static str,
}

/// The last part of the name of an artefact in a folder of others, for its files.
pub(super) fn stem(name: &str) -> &str {
    name.rsplit('/').next().unwrap_or(name)
}

/// A figure of a page.
#[derive(Clone, Debug)]
pub(super) struct PageFigure {
    /// Name of its files, without extension.
    pub name: String,
    /// Caption.
    pub caption: String,
    /// The figure.
    pub figure: Figure,
}

impl PageFigure {
    /// Creates a figure with its name and caption.
    pub fn new(name: &str, caption: &str, figure: Figure) -> Self {
        Self {
            name: name.into(),
            caption: caption.into(),
            figure,
        }
    }

    /// The figure and its caption as Markdown for a page, from the file with an extension.
    pub fn in_markdown(&self, ending: &str) -> String {
        let Self { name, caption, .. } = self;
        format!(
            "![{caption}]({name}.{ending})\n\n{}",
            wrapped(&format!("*{caption}*"))
        )
    }
}

/// Writes a figure into the directory of its page in all requested formats; returns the paths.
pub(super) fn write_figures(
    directory: &Path,
    figure: &PageFigure,
    options: &FigureOptions,
) -> Result<Vec<PathBuf>, ResultsError> {
    // Do not use `with_extension`, since names such as `fig2.7` contain a dot.
    let path = directory.join(format!("{}.svg", figure.name));
    write_figure(&path, &figure.figure, options)
}

/// The page of an artefact while it is written to its directory.
pub(super) struct Page {
    heading: Heading,
    directory: PathBuf,
    manifest: PageManifest,
    markdown: String,
    written: Vec<PathBuf>,
    figures: FigureOptions,
    /// Figures that are not placed yet.
    held: VecDeque<PageFigure>,
}

/// Creates a table with a line for each row: the heading and the cells of each column.
macro_rules! columns {
    ($row:pat in $rows:expr; $($head:expr => $cell:expr,)+) => {
        $crate::reproduce::page::MarkdownTable {
            header: vec![$($head),+],
            lines: $rows.into_iter().map(|$row| vec![$(String::from($cell)),+]).collect(),
        }
    };
}
pub(super) use columns;

/// A table of a page.
pub(super) struct MarkdownTable<'a> {
    /// Headings of the columns.
    pub header: Vec<&'a str>,
    /// Cells of the lines.
    pub lines: Vec<Vec<String>>,
}

/// Origin of an artefact.
#[derive(Serialize)]
struct PageManifest {
    artifact: &'static str,
    title: &'static str,
    version: &'static str,
    commit: Option<&'static str>,
    command_line: Vec<String>,
    written: jiff::Timestamp,
    /// Whether only a short time was simulated.
    quick: bool,
    /// Number of simultaneous runs in this call.
    jobs: usize,
    cases: Vec<CaseNote>,
}

/// Origin of a run.
#[derive(Serialize)]
struct CaseNote {
    case: String,
    status: CaseStatus,
    simulated_time_s: f64,
    wall_time_s: f64,
    /// Processor time of the process during the run, including simultaneous runs.
    cpu_time_s: Option<f64>,
    threads: usize,
    version: String,
    /// Whether an earlier call has finished the run.
    was_finished: bool,
}

/// Whether a folder holds the complete page of an artefact, not a quick version.
pub(super) fn is_whole(page: &Path) -> bool {
    let manifest = std::fs::read(page.join(MANIFEST)).ok();
    let manifest = manifest.and_then(|bytes| serde_json::from_slice(&bytes).ok());
    manifest.is_some_and(|manifest: serde_json::Value| manifest["quick"] == false)
}

/// Checks that the page and the manifest in a folder, if there are any, are those of an artefact.
///
/// # Errors
/// [`ResultsError::NotOwn`].
pub(super) fn check_place(folder: &Path, heading: &Heading) -> Result<(), ResultsError> {
    let entry = format!("\"artifact\": \"{}\"", heading.name);
    let manifest = folder.join(MANIFEST);
    check_own(&manifest, |head| {
        String::from_utf8_lossy(head).contains(&entry)
    })?;
    if manifest.exists() {
        // The title may be that of an earlier version.
        return Ok(());
    }
    let title = format!("# {}", heading.title);
    check_own(&folder.join("README.md"), |head| {
        head.starts_with(title.as_bytes())
    })
}

impl Page {
    /// Creates the directory and the head of the page.
    pub fn begin<R: Run>(
        heading: Heading,
        options: &ReproduceOptions,
        cases: &[Case<R>],
    ) -> Result<Self, ResultsError> {
        let directory = options.directory.join(heading.name);
        std::fs::create_dir_all(&directory).map_err(|source| ResultsError::Io {
            action: "create",
            path: directory.clone(),
            source,
        })?;
        let note = |case: &Case<R>| CaseNote {
            case: case.run.id(),
            status: case.record.status,
            simulated_time_s: case.record.outcome.simulated_time,
            wall_time_s: case.record.wall_time,
            cpu_time_s: case.record.cpu_time,
            threads: case.manifest.threads,
            version: case.manifest.version.clone(),
            was_finished: case.was_finished,
        };
        Ok(Self {
            markdown: head(heading, options, cases),
            manifest: PageManifest {
                artifact: heading.name,
                title: heading.title,
                version: VERSION,
                commit: commit(),
                command_line: options.command_line.clone(),
                written: jiff::Timestamp::now(),
                quick: options.quick,
                jobs: options.jobs,
                cases: cases.iter().map(note).collect(),
            },
            heading,
            directory,
            written: Vec::new(),
            figures: options.figures.clone(),
            held: VecDeque::new(),
        })
    }

    /// Name of directories and files of the artefact.
    pub fn name(&self) -> &'static str {
        self.heading.name
    }

    /// Whether this is the quick version.
    pub fn is_quick(&self) -> bool {
        self.manifest.quick
    }

    /// Writes rows as a CSV file named after the artefact.
    pub fn csv(&mut self, rows: &[impl Serialize]) -> Result<(), ResultsError> {
        self.csv_as(&format!("{}.csv", stem(self.heading.name)), rows)
    }

    /// Writes rows as a CSV file.
    pub fn csv_as(&mut self, name: &str, rows: &[impl Serialize]) -> Result<(), ResultsError> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        for row in rows {
            writer.serialize(row).expect("plain rows go into memory");
        }
        let bytes = writer.into_inner().expect("memory takes all bytes");
        self.file(name, &bytes)
    }

    /// Writes a figure and shows it on the page.
    pub fn figure(&mut self, figure: &PageFigure) -> Result<(), ResultsError> {
        let formats = &self.figures.formats;
        let shown = formats.first().map_or("svg", |format| format.ending());
        self.text(&figure.in_markdown(shown));
        let files = write_figures(&self.directory, figure, &self.figures)?;
        self.written.extend(files);
        Ok(())
    }

    /// Holds figures for [`Self::next_figure`].
    pub fn hold(&mut self, figures: Vec<PageFigure>) {
        self.held = figures.into();
    }

    /// Places the first figure that has not been placed yet.
    pub fn next_figure(&mut self) -> Result<(), ResultsError> {
        let figure = self.held.pop_front();
        figure.map_or(Ok(()), |figure| self.figure(&figure))
    }

    /// Places all figures that have not been placed yet.
    pub fn figures(&mut self) -> Result<(), ResultsError> {
        while !self.held.is_empty() {
            self.next_figure()?;
        }
        Ok(())
    }

    /// Copies a file of a run into the directory of the page, if it exists.
    pub fn copy(&mut self, from: &Path, name: &str) -> Result<(), ResultsError> {
        if !from.exists() {
            return Ok(());
        }
        let bytes = std::fs::read(from).map_err(|source| ResultsError::Io {
            action: "read",
            path: from.to_owned(),
            source,
        })?;
        self.file(name, &bytes)
    }

    /// Adds a paragraph to the page.
    pub fn text(&mut self, paragraph: &str) {
        self.markdown += &wrapped(paragraph);
        self.markdown += "\n\n";
    }

    /// Adds a table to the page.
    pub fn table(&mut self, table: MarkdownTable<'_>) {
        self.lines(&table.header, &table.lines);
    }

    /// Adds a table with a header and lines to the page.
    pub fn lines(&mut self, header: &[&str], rows: &[Vec<String>]) {
        let line = |cells: &[String]| format!("| {} |\n", cells.join(" | "));
        let header: Vec<String> = header.iter().map(|&cell| cell.to_owned()).collect();
        let rule = vec!["---".to_owned(); header.len()];
        let mut table = line(&header) + &line(&rule);
        for row in rows {
            table += &line(row);
        }
        self.text(table.trim_end());
    }

    /// Writes the Markdown page and the manifest; returns all files written.
    pub fn finish(mut self) -> Result<Vec<PathBuf>, ResultsError> {
        let text = std::mem::take(&mut self.markdown);
        self.file("README.md", (text.trim_end().to_owned() + "\n").as_bytes())?;
        let manifest =
            serde_json::to_string_pretty(&self.manifest).expect("a manifest has string keys only");
        self.file(MANIFEST, (manifest + "\n").as_bytes())?;
        Ok(self.written)
    }

    /// Writes a file beside the page.
    pub fn file(&mut self, name: &str, bytes: &[u8]) -> Result<(), ResultsError> {
        let path = self.directory.join(name);
        write_whole(&path, bytes)?;
        self.written.push(path);
        Ok(())
    }
}

/// Title, command, and remarks on times and timings.
fn head<R: Run>(heading: Heading, options: &ReproduceOptions, cases: &[Case<R>]) -> String {
    let mut text = format!("# {}\n\n", heading.title);
    let mut add = |paragraph: String| {
        // Writing to a string cannot fail.
        let _ = write!(text, "{}\n\n", wrapped(&paragraph));
    };
    let quick = if options.quick { " --quick" } else { "" };
    add(format!(
        "Made by `rodlab reproduce {}{quick}`, version {}.",
        heading.name, VERSION
    ));
    let longest = cases
        .iter()
        .max_by(|a, b| a.run.end().total_cmp(&b.run.end()));
    if let Some(longest) = longest.filter(|_| options.quick) {
        add(format!(
            "**Quick version: only {}. Totals and end times are those of this part.**",
            longest.run.extent()
        ));
    }
    let jobs = options.jobs.min(cases.len());
    let at_a_time = if jobs == 1 {
        "one at a time".to_owned()
    } else {
        format!("{jobs} at a time, which slows down each of them")
    };
    let threads = threads_of_a_job(options.jobs);
    let before = cases.iter().filter(|case| case.was_finished).count();
    let mut timings =
        format!("Wall times: runs of this call were made {at_a_time}; threads of each: {threads}.");
    if before > 0 {
        timings += &format!(
            " {before} of {} runs were made by earlier calls; their times were measured then.",
            cases.len()
        );
    }
    if let Some(ratio) = wall_time_over_cpu_time(cases).filter(|_| jobs * threads == 1) {
        timings += &format!(
            " Total wall time over total processor time is {ratio:.2}; above 1 the machine was busy with other work."
        );
    }
    add(timings);
    text
}

fn wall_time_over_cpu_time<R: Run>(cases: &[Case<R>]) -> Option<f64> {
    let cpu_times = cases.iter().map(|case| case.record.cpu_time);
    let cpu_time: f64 = cpu_times.sum::<Option<f64>>()?;
    let wall_time: f64 = cases.iter().map(|case| case.record.wall_time).sum();
    (cpu_time > 0.0).then(|| wall_time / cpu_time)
}

/// A number of the page, or a dash.
pub(super) fn number(value: impl Into<Option<f64>>, decimals: usize) -> String {
    let value = value.into();
    value.map_or("–".to_owned(), |value| format!("{value:.decimals$}"))
}

/// A count in units of a power of ten, as printed in the thesis: 6.01×10⁵ is `6.01e5`.
pub(super) fn count(value: f64) -> String {
    format!("{value:.2e}")
}
