//! Resolving rods.

use super::cross_section::{check_wall, cross_section_of};
use super::sections::sections;
use super::{model, shape};
use crate::scenario::resolved::{
    CrossSection, Inertia, Material, NaturalShape, Rod, Shape, Stiffness,
};
use crate::scenario::section::Section;
use crate::scenario::typed::{self, ScenarioFile};

/// Maximum number of edges: larger numbers are taken for typing errors.
pub const MOST_EDGES: usize = 1_000_000;

/// Resolves all rods: those of a general `scene`, or those in addition to the rods that another
/// experiment builds.
pub fn rods(
    top: &Section<'_>,
    file: &ScenarioFile,
    experiment: Option<&str>,
    lumped: bool,
) -> Vec<Rod> {
    let meets = model::touches(file) || model::flows(file);
    let vibrates = experiment == Some("scene") && !meets && !lumped;
    let common = CommonMaterial::of(top, file);
    let section = top.below("rods");
    let rods = top.elements("rods", &file.rods).enumerate();
    let rods: Vec<Rod> = rods
        .map(|(index, (section, typed))| rod(&section, typed, index, &common, vibrates))
        .collect();
    for (index, rod) in rods.iter().enumerate() {
        if let Some(first) = rods[..index]
            .iter()
            .position(|other| other.name == rod.name)
        {
            section.below(&index.to_string()).fault(
                "name",
                format!(
                    "rod {first} has the same name, `{}`; names must be unique",
                    rod.name
                ),
            );
        }
    }
    rods
}

fn rod(
    section: &Section<'_>,
    typed: &typed::Rod,
    index: usize,
    common: &CommonMaterial<'_>,
    vibrates: bool,
) -> Rod {
    let shape = typed.shape.as_ref().map_or_else(
        || {
            section.missing(
                "shape",
                "a table such as { kind = \"straight\", start = [0, 0, 0], end = [1, 0, 0] }",
            );
            Shape::Points { points: Vec::new() }
        },
        |typed| shape::shape(&section.below("shape"), typed),
    );
    let closed = closed(section, typed.closed, &shape);
    let member = Member {
        name: name(section, typed.name.as_deref(), index),
        edges: edges(section, typed.edges, &shape, closed),
        shape,
    };
    let rod = self::member(section, typed, common, member);
    if let Shape::Coil { spacing, .. } = rod.shape
        && spacing <= 2.0 * rod.radius
    {
        let diameter = 2.0 * rod.radius;
        section.below("shape").out_of_range(
            "spacing",
            format_args!("{spacing:?} m"),
            format_args!("greater than the diameter of the rod, {diameter:?} m"),
        );
    }
    if closed && matches!(rod.natural_shape, NaturalShape::Strains(_)) {
        section.fault(
            "natural_shape",
            "a closed rod has no natural strains over the arc length; allowed: as-placed, straight, curved, helix, arc, ring, points",
        );
    }
    let rod = Rod { closed, ..rod };
    let sections = sections(section, typed, &rod);
    let is_uniform = sections.is_empty();
    let gains = vibrates && is_uniform && is_straight(&rod.natural_shape, &rod.shape);
    let inertia = inertia(typed.inertia(section), gains);
    if !is_uniform && inertia == Inertia::Consistent {
        section.fault(
            "inertia",
            "a rod with `sections` needs \"lumped\" inertia, the default",
        );
    }
    Rod {
        inertia,
        sections,
        ..rod
    }
}

/// One of several rods of the same kind.
pub struct Member {
    /// Name of the member.
    pub name: String,
    /// Number of edges.
    pub edges: usize,
    /// Placed shape of the member.
    pub shape: Shape,
}

/// Resolves an open rod with lumped inertia and a given name, number of edges and shape.
pub fn member(
    section: &Section<'_>,
    typed: &typed::Rod,
    common: &CommonMaterial<'_>,
    member: Member,
) -> Rod {
    let material = own_material(&section.below("material"), &typed.material, common);
    let below = section.below("cross_section");
    let cross_section = cross_section_of(&below, typed.cross_section.as_ref());
    let radius = match cross_section {
        CrossSection::Circle | CrossSection::Tube { .. } => typed.radius(section),
        CrossSection::Rectangle { .. } if typed.radius.is_some() => typed.radius(section),
        CrossSection::Rectangle { width, thickness } => width.min(thickness) / 2.0,
    };
    check_wall(section, &cross_section, radius);
    let derived = cross_section.stiffness(radius, &material);
    let below = section.below("stiffness");
    let stiffness = typed.stiffness.resolve(&below, derived);
    refuse_degenerate(section, &stiffness);
    if material.yield_stress > 0.0 && stiffness != derived {
        section.fault(
            "stiffness",
            "a rod with a yield stress has the stiffness of its material and cross-section",
        );
    }
    let natural_shape = natural_shape(section, typed);
    Rod {
        name: member.name,
        radius,
        edges: member.edges,
        closed: false,
        held: typed.held(section),
        inertia: Inertia::Lumped,
        pretension: pretension(section, typed, &natural_shape, stiffness.stretching),
        natural_shape,
        twist: typed.twist(section),
        director: typed.director(section),
        stiffness,
        sections: Vec::new(),
        friction: typed.friction(section),
        material,
        cross_section,
        velocity: typed.velocity(section),
        angular_velocity: typed.angular_velocity(section),
        shape: member.shape,
    }
}

/// The requested inertia, or the best one for the rod: consistent if this makes vibrations
/// fourth-order accurate, lumped if other errors dominate.
fn inertia(choice: typed::InertiaChoice, gains: bool) -> Inertia {
    match choice {
        typed::InertiaChoice::Auto if gains => Inertia::Consistent,
        typed::InertiaChoice::Auto | typed::InertiaChoice::Lumped => Inertia::Lumped,
        typed::InertiaChoice::Consistent => Inertia::Consistent,
    }
}

/// Whether the natural shape of a rod is straight and untwisted.
fn is_straight(natural: &NaturalShape, placed: &Shape) -> bool {
    match natural {
        NaturalShape::Straight => true,
        NaturalShape::AsPlaced => matches!(placed, Shape::Straight { .. }),
        NaturalShape::Curved { curvature, twist } => *curvature == [0.0; 2] && *twist == 0.0,
        NaturalShape::Curve(shape) => matches!(shape, Shape::Straight { .. }),
        NaturalShape::Strains(_) => false,
    }
}

/// Largest fraction of its length by which a rod may be compressed initially.
const MOST_SHORTENED: f64 = 0.9;

/// The tension in a placed rod, N. The natural lengths follow from it and the placed lengths.
fn pretension(
    section: &Section<'_>,
    typed: &typed::Rod,
    natural_shape: &NaturalShape,
    stretching: f64,
) -> f64 {
    let tension = typed.pretension(section);
    if tension != 0.0
        && matches!(
            natural_shape,
            NaturalShape::Curve(_) | NaturalShape::Strains(_)
        )
    {
        let message = "the natural shape has its own lengths; give it or `pretension`, not both";
        section.fault("pretension", message);
    }
    let least = -MOST_SHORTENED * stretching;
    if tension < least {
        let allowed = format_args!("at least -0.9 EA = {least:?} N");
        section.out_of_range("pretension", format_args!("{tension:?} N"), allowed);
    }
    tension
}

/// The name of a rod, or of a table that makes rods.
pub fn name(section: &Section<'_>, typed: Option<&str>, index: usize) -> String {
    let Some(name) = typed else {
        return format!("rod_{}", index + 1);
    };
    let fits = |character: char| character.is_alphanumeric() || matches!(character, '_' | '-');
    if name.is_empty() || !name.chars().all(fits) || name.chars().all(|c| c.is_ascii_digit()) {
        section.fault(
            "name",
            format!(
                "{name:?} cannot be a name; allowed: letters, digits, `_` and `-`, not digits alone"
            ),
        );
    }
    name.to_owned()
}

/// The common material of all rods, and its place in the file.
pub struct CommonMaterial<'a> {
    section: Section<'a>,
    typed: Option<&'a typed::Material>,
}

impl<'a> CommonMaterial<'a> {
    /// That of a file.
    pub fn of(top: &Section<'a>, file: &'a ScenarioFile) -> Self {
        Self {
            section: top.below("material"),
            typed: file.material.as_ref(),
        }
    }
}

/// Resolves a rod's material from its own keys, or else from the common ones.
fn own_material(
    section: &Section<'_>,
    own: &typed::Material,
    common: &CommonMaterial<'_>,
) -> Material {
    let nothing = typed::Material::default();
    let of_all = common.typed.unwrap_or(&nothing);
    macro_rules! choose {
        ($key:ident) => {
            match own.$key {
                Some(_) => own.$key(section),
                None => of_all.$key(&common.section),
            }
        };
    }
    let youngs_modulus = choose!(youngs_modulus);
    let of_common = |typed| viscosity(&common.section, typed, youngs_modulus);
    let relaxing = relaxation(section, own).or_else(|| {
        common
            .typed
            .and_then(|typed| relaxation(&common.section, typed))
    });
    let [relaxing_modulus, relaxation_time] = relaxing.unwrap_or_default();
    let [yield_stress, tangent_modulus] = yielding(section, own, youngs_modulus)
        .or_else(|| {
            let typed = common.typed?;
            yielding(&common.section, typed, youngs_modulus)
        })
        .unwrap_or_default();
    Material {
        youngs_modulus,
        poissons_ratio: choose!(poissons_ratio),
        density: choose!(density),
        viscosity: viscosity(section, own, youngs_modulus)
            .or_else(|| common.typed.and_then(of_common))
            .unwrap_or(0.0),
        relaxing_modulus,
        relaxation_time,
        yield_stress,
        tangent_modulus,
    }
}

/// Yield stress and tangent modulus, Pa, if a yield stress is given.
fn yielding(
    section: &Section<'_>,
    typed: &typed::Material,
    youngs_modulus: f64,
) -> Option<[f64; 2]> {
    let stress = typed.yield_stress(section);
    let modulus = typed.tangent_modulus(section);
    if let Some(modulus) = modulus.filter(|modulus| *modulus >= youngs_modulus) {
        let allowed = format_args!("less than Young's modulus, {youngs_modulus:?} Pa");
        section.out_of_range("tangent_modulus", format_args!("{modulus:?} Pa"), allowed);
    }
    if stress.is_none() && modulus.is_some() {
        section.missing("yield_stress", "the stress beyond which it is the modulus");
    }
    stress.map(|stress| [stress, modulus.unwrap_or(0.0)])
}

/// Relaxing modulus, Pa, and relaxation time, s, if given.
fn relaxation(section: &Section<'_>, typed: &typed::Material) -> Option<[f64; 2]> {
    let modulus = typed.relaxing_modulus(section);
    let time = typed.relaxation_time(section);
    match (modulus, time) {
        (Some(modulus), Some(time)) => return Some([modulus, time]),
        (None, None) => {}
        (None, Some(_)) => section.missing("relaxing_modulus", "the modulus that relaxes"),
        (Some(_), None) => {
            section.missing(
                "relaxation_time",
                "the time in which `relaxing_modulus` relaxes",
            );
        }
    }
    None
}

/// The viscosity of a material, Pa s, given directly or by its loss factor.
fn viscosity(section: &Section<'_>, typed: &typed::Material, youngs_modulus: f64) -> Option<f64> {
    let viscosity = typed.viscosity(section);
    let factor = typed.loss_factor(section);
    let frequency = typed.loss_frequency(section);
    match (viscosity, factor, frequency) {
        (_, None, Some(_)) => section.missing("loss_factor", "the loss factor at `loss_frequency`"),
        (_, Some(_), None) => {
            section.missing(
                "loss_frequency",
                "the frequency at which that is the loss factor",
            );
        }
        (Some(_), Some(_), Some(_)) => {
            section.fault("loss_factor", "give `viscosity` or `loss_factor`, not both");
        }
        (viscosity, None, None) => return viscosity,
        (None, Some(factor), Some(frequency)) => {
            return Some(factor * youngs_modulus / (std::f64::consts::TAU * frequency));
        }
    }
    None
}

/// Resolves the common material of all rods.
pub fn material(section: &Section<'_>, typed: &typed::Material) -> Material {
    let youngs_modulus = typed.youngs_modulus(section);
    let [relaxing_modulus, relaxation_time] = relaxation(section, typed).unwrap_or_default();
    let [yield_stress, tangent_modulus] =
        yielding(section, typed, youngs_modulus).unwrap_or_default();
    Material {
        youngs_modulus,
        poissons_ratio: typed.poissons_ratio(section),
        density: typed.density(section),
        viscosity: viscosity(section, typed, youngs_modulus).unwrap_or(0.0),
        relaxing_modulus,
        relaxation_time,
        yield_stress,
        tangent_modulus,
    }
}

/// Rejects stiffnesses that underflow or overflow. NaN follows from a fault that was reported.
pub fn refuse_degenerate(section: &Section<'_>, stiffness: &Stiffness) {
    let values = [
        stiffness.stretching,
        stiffness.bending_1,
        stiffness.bending_2,
        stiffness.twisting,
    ];
    if values
        .iter()
        .any(|&value| value == 0.0 || value.is_infinite())
    {
        section.fault(
            "radius",
            format!(
                "radius and material give the stiffnesses EA = {:?} N, EI = {:?} N m²; check their units",
                stiffness.stretching, stiffness.bending_1
            ),
        );
    }
}

fn closed(section: &Section<'_>, typed: Option<bool>, shape: &Shape) -> bool {
    match (typed, shape) {
        (Some(false), Shape::Ring { .. }) => {
            section.fault_with_help(
                "closed",
                "a ring is closed",
                Some("for an open circle use kind = \"arc\"".to_owned()),
            );
            false
        }
        (_, Shape::Ring { .. }) => true,
        (
            Some(true),
            Shape::Straight { .. }
            | Shape::Helix { .. }
            | Shape::Arc { .. }
            | Shape::Catenary { .. }
            | Shape::Slack { .. }
            | Shape::Coil { .. },
        ) => {
            section.fault(
                "closed",
                "only rods of kind \"ring\" or \"points\" can be closed",
            );
            true
        }
        (typed, _) => typed.unwrap_or(false),
    }
}

fn edges(section: &Section<'_>, typed: Option<i64>, shape: &Shape, closed: bool) -> usize {
    let fewest = match shape {
        // A closed rod of two edges would fold onto itself.
        _ if closed => 3,
        Shape::Slack { .. } => 2,
        // Edges longer than the inner radius could not follow its curvature.
        Shape::Coil {
            inner_radius,
            length,
            ..
        } => (length / inner_radius).ceil().clamp(1.0, MOST_EDGES as f64) as usize,
        _ => 1,
    };
    let corners = match shape {
        Shape::Points { points } if typed.is_none() => points.len(),
        _ => {
            return section
                .count("edges", typed, fewest..=MOST_EDGES)
                .unwrap_or(fewest);
        }
    };
    let edges = if closed {
        corners
    } else {
        corners.saturating_sub(1)
    };
    // An empty polyline has already been reported.
    if corners > 0 && edges < fewest {
        section.fault(
            "shape",
            format!("a closed rod needs at least {fewest} points"),
        );
    }
    edges.max(fewest)
}

fn natural_shape(section: &Section<'_>, typed: &typed::Rod) -> NaturalShape {
    let curved = typed.natural_curvature.is_some() || typed.natural_twist.is_some();
    match &typed.natural_shape {
        Some(_) if curved => {
            section.fault(
                "natural_shape",
                "give `natural_shape`, or `natural_curvature` and `natural_twist`, not both",
            );
            NaturalShape::AsPlaced
        }
        Some(natural) => shape::natural_shape(&section.below("natural_shape"), natural),
        None if curved => NaturalShape::Curved {
            curvature: typed.natural_curvature(section).unwrap_or_default(),
            twist: typed.natural_twist(section).unwrap_or(0.0),
        },
        None => NaturalShape::AsPlaced,
    }
}
