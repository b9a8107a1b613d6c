//! Faults of scenarios, shown with the surrounding text.

use super::issue::Issue;
use super::source::{Sources, Span, line_and_column};
use miette::{
    Diagnostic, GraphicalReportHandler, GraphicalTheme, LabeledSpan, NamedSource, SourceCode,
};
use std::fmt;
use std::sync::Arc;

/// All faults of a scenario.
#[derive(Clone, Debug)]
pub struct ScenarioError(pub Vec<Located>);

/// A fault and its place.
#[derive(Clone, Debug)]
pub struct Located {
    /// The fault.
    pub issue: Issue,
    place: Option<Place>,
}

#[derive(Clone, Debug)]
struct Place {
    name: String,
    span: Span,
    /// `None` in a table in memory, which has no text.
    text: Option<TextPlace>,
}

#[derive(Clone, Debug)]
struct TextPlace {
    source: NamedSource<Arc<str>>,
    line: usize,
    column: usize,
}

impl Located {
    /// A fault at a position in one of the sources, or without position.
    pub fn new(sources: &Sources, issue: Issue, span: Option<Span>) -> Self {
        let place = span.map(|span| {
            let source = sources.get(span.source);
            let text = source.text.as_ref().map(|text| {
                let (line, column) = line_and_column(text, span.bytes.start);
                TextPlace {
                    source: NamedSource::new(&source.name, text.clone()),
                    line,
                    column,
                }
            });
            Place {
                name: source.name.clone(),
                span,
                text,
            }
        });
        Self { issue, place }
    }

    /// Line and column, counted from one; `None` in a table in memory.
    pub fn line_and_column(&self) -> Option<(usize, usize)> {
        let text = self.place.as_ref()?.text.as_ref()?;
        Some((text.line, text.column))
    }

    /// Key for sorting faults in the order in which their texts were read.
    pub(super) fn order(&self) -> (usize, usize) {
        self.place
            .as_ref()
            .map_or((0, 0), |place| (place.span.source, place.span.bytes.start))
    }
}

impl fmt::Display for Located {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.issue.fmt(formatter)
    }
}

impl std::error::Error for Located {}

impl Diagnostic for Located {
    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        let help = self.issue.help.as_ref()?;
        Some(Box::new(help))
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        let text = self.place.as_ref()?.text.as_ref()?;
        Some(&text.source)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        let place = self.place.as_ref().filter(|place| place.text.is_some())?;
        let label = LabeledSpan::new_with_span(Some("here".to_owned()), place.span.bytes.clone());
        Some(Box::new(std::iter::once(label)))
    }
}

impl From<Located> for ScenarioError {
    fn from(located: Located) -> Self {
        Self(vec![located])
    }
}

impl std::error::Error for ScenarioError {}

impl fmt::Display for ScenarioError {
    /// One line per fault: `file:line:column: key: message (help)`. For a table in memory the name
    /// replaces file, line and column.
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (number, located) in self.0.iter().enumerate() {
            if number > 0 {
                writeln!(formatter)?;
            }
            if let Some(place) = &located.place {
                write!(formatter, "{}", place.name)?;
                if let Some(text) = &place.text {
                    write!(formatter, ":{}:{}", text.line, text.column)?;
                }
                write!(formatter, ": ")?;
            }
            write!(formatter, "{located}")?;
            if let Some(help) = &located.issue.help {
                write!(formatter, " ({help})")?;
            }
        }
        Ok(())
    }
}

impl ScenarioError {
    /// The faults with the affected lines of text, for a terminal.
    pub fn render(&self, colour: bool) -> String {
        let theme = if colour {
            GraphicalTheme::unicode()
        } else {
            GraphicalTheme::unicode_nocolor()
        };
        let handler = GraphicalReportHandler::new_themed(theme)
            .with_width(100)
            .with_links(false);
        let mut text = String::new();
        for located in &self.0 {
            if handler.render_report(&mut text, located).is_err() {
                return self.to_string();
            }
        }
        text
    }
}
