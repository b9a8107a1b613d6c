//! Options of the search for strands.

use super::VisionError;
use super::colour::ColourRule;
use super::region::Region;

/// Options of the search for strands.
#[derive(Clone, Debug, PartialEq)]
pub struct TraceOptions {
    /// Colours of the rod.
    ///
    /// With [`ColourRule::Background`], the result of another rule may be used: see
    /// [`trace()`](super::trace()).
    pub colour: ColourRule,
    /// Further colours; strands of different rules are separate.
    pub more_colours: Vec<ColourRule>,
    /// Part of the image that is searched.
    pub region: Option<Region>,
    /// Number of rods: the strands that look most like rods are kept.
    pub strands: Option<usize>,
    /// Least length of a strand, pixels.
    pub least_length: f64,
    /// Least number of pixels of a part of the mask; smaller parts are noise.
    pub least_area: usize,
    /// Number of pixels below which a hole of the mask is a highlight of a rod, not a loop.
    pub largest_hole: usize,
    /// Whether lines may have sharp corners, as drawn ones have. Rods bend round: two that meet in a
    /// corner touch with their ends.
    pub has_corners: bool,
    /// Least length of a strand, in widths; shorter ones are not lines.
    pub least_slenderness: f64,
}

impl TraceOptions {
    /// The default options with colours as in the option `--colour` of `rodlab trace`.
    ///
    /// # Errors
    /// A colour rule cannot be parsed.
    pub fn of_colours<'a>(
        rules: impl IntoIterator<Item = &'a String>,
    ) -> Result<Self, VisionError> {
        let rules = rules.into_iter().map(|rule| ColourRule::parse(rule));
        let mut rules = rules.collect::<Result<Vec<_>, _>>()?.into_iter();
        Ok(Self {
            colour: rules.next().unwrap_or(ColourRule::Background),
            more_colours: rules.collect(),
            ..Self::default()
        })
    }
}

impl Default for TraceOptions {
    fn default() -> Self {
        Self {
            colour: ColourRule::Background,
            more_colours: Vec::new(),
            region: None,
            strands: None,
            least_length: 0.0,
            least_area: 60,
            largest_hole: 20,
            has_corners: false,
            least_slenderness: 3.0,
        }
    }
}
