//! Sections of a rod: means over its edges, and natural strains at its nodes.

use super::curve::sample;
use crate::scenario::{Issue, KeyPath, Material, NaturalShape, Rod, RodSection, Shape};
use rodlab_engine::mechanics::Vector3;
use rodlab_engine::mechanics::scene::{
    EdgeSection, NaturalStrains, Section, Stiffness, edge_sections, pieces,
};

/// Edges with which the length of a curve is measured: its relative error is below 1e-6.
const FINE: usize = 4000;

/// Relative length by which sections may exceed the rod, for rounding and the error of [`FINE`].
const BEYOND: f64 = 2e-6;

/// A rod with sections.
pub(super) struct LaidOut {
    /// The sections of its edges.
    pub edges: Vec<EdgeSection>,
    /// Lengths of its edges as placed, m.
    pub lengths: Vec<f64>,
    /// Natural strains, if sections have natural curvatures or twists.
    pub natural: Option<NaturalStrains>,
}

/// Lays the sections of a rod along the edges between its nodes.
///
/// # Errors
/// [`Issue`] names the end of a section that is beyond the rod.
pub(super) fn lay_out(rod: &Rod, nodes: &[Vector3], path: &KeyPath) -> Result<LaidOut, Issue> {
    let lengths = lengths(nodes, rod.closed);
    let edges: f64 = lengths.iter().sum();
    let length = curve_length(rod).unwrap_or(edges);
    let sections = within(rod, length, path)?;
    let mut places = vec![0.0];
    for edge in &lengths {
        places.push(places[places.len() - 1] + edge * length / edges);
    }
    let mut joints: Vec<f64> = sections.iter().flat_map(|one| one.span).collect();
    joints.dedup();
    let base = rod.cross_section.stiffness(rod.radius, &rod.material);
    let at = |place: f64| {
        let own = section_at(&sections, place);
        section(rod, &base, own.map(|one| (one.section, one.part(place))))
    };
    let bent = rod.sections.iter().any(RodSection::is_naturally_bent);
    Ok(LaidOut {
        edges: edge_sections(&places, &joints, &at),
        natural: bent.then(|| natural_strains(rod, &sections, &places, &joints, &lengths)),
        lengths,
    })
}

/// A section and the arc lengths of its ends, m.
struct Placed<'a> {
    section: &'a RodSection,
    span: [f64; 2],
}

impl Placed<'_> {
    /// Position in the section, 0 to 1.
    fn part(&self, place: f64) -> f64 {
        (place - self.span[0]) / (self.span[1] - self.span[0])
    }
}

/// The section at an arc length, m; `None` between sections.
fn section_at<'a>(sections: &'a [Placed<'a>], place: f64) -> Option<&'a Placed<'a>> {
    let is_at = |one: &&Placed<'_>| one.span[0] <= place && place < one.span[1];
    sections.iter().find(is_at)
}

fn lengths(nodes: &[Vector3], closed: bool) -> Vec<f64> {
    let edges = nodes.len() - usize::from(!closed);
    let length = |edge: usize| (nodes[(edge + 1) % nodes.len()] - nodes[edge]).norm();
    (0..edges).map(length).collect()
}

/// Length of the curve along which a rod is placed, m; `None` if it is that of its edges.
fn curve_length(rod: &Rod) -> Option<f64> {
    let edges = match &rod.shape {
        Shape::Straight { .. } => return None,
        Shape::Points { points } => points.len() - usize::from(!rod.closed),
        _ => FINE,
    };
    let nodes = sample(&rod.shape, edges, rod.closed).nodes;
    Some(lengths(&nodes, rod.closed).iter().sum())
}

/// The sections with their ends on a rod of a length, m.
fn within<'a>(rod: &'a Rod, length: f64, path: &KeyPath) -> Result<Vec<Placed<'a>>, Issue> {
    let mut placed = Vec::new();
    for (index, section) in rod.sections.iter().enumerate() {
        let path = path.key("sections").key(&index.to_string());
        let beyond = |key: &str, place: f64, allowed: &str| {
            let message = format!(
                "{place:?} m is out of range; allowed: {allowed} the length of the rod, {length:.6} m"
            );
            Err(Issue::new(path.key(key), message))
        };
        let to = section.to.unwrap_or(length);
        if section.from >= length {
            return beyond("from", section.from, "less than");
        }
        if to > length * (1.0 + BEYOND) {
            return beyond("to", to, "at most");
        }
        let span = [section.from, to.min(length)];
        placed.push(Placed { section, span });
    }
    Ok(placed)
}

/// The cross-section of a rod, or of a part of one of its sections. Stiffnesses that are given for
/// the rod change in proportion to those of material and cross-section, `base` for the rod.
fn section(
    rod: &Rod,
    base: &crate::scenario::Stiffness,
    own: Option<(&RodSection, f64)>,
) -> Section {
    let (radius, cross_section, material) = match own {
        None => (rod.radius, rod.cross_section, rod.material),
        Some((section, part)) => {
            let (radius, cross_section) = section.at(part);
            let material = Material {
                youngs_modulus: section.youngs_modulus,
                poissons_ratio: section.poissons_ratio,
                density: section.density,
                ..rod.material
            };
            (radius, cross_section, material)
        }
    };
    let derived = cross_section.stiffness(radius, &material);
    let given = &rod.stiffness;
    let moments = cross_section.second_moments(radius);
    Section {
        stiffness: Stiffness {
            stretching: given.stretching * (derived.stretching / base.stretching),
            bending: [
                given.bending_1 * (derived.bending_1 / base.bending_1),
                given.bending_2 * (derived.bending_2 / base.bending_2),
            ],
            twisting: given.twisting * (derived.twisting / base.twisting),
        },
        radius,
        mass_per_length: material.density * cross_section.area(radius),
        rotational_inertia_per_length: material.density * (moments[0] + moments[1]),
        friction: own
            .and_then(|(section, _)| section.friction)
            .or(rod.friction),
    }
}

/// Natural strains at the nodes of an open rod: the integral ∫ κ φ ds of the curvature with the hat
/// function φ of the node, so that nodes are on the natural shape, and the integral of the twist
/// between the middles of the edges at the node. Both are divided by half of the length of these
/// edges.
fn natural_strains(
    rod: &Rod,
    sections: &[Placed<'_>],
    places: &[f64],
    joints: &[f64],
    lengths: &[f64],
) -> NaturalStrains {
    let (curvature, twist) = match &rod.natural_shape {
        NaturalShape::Curved { curvature, twist } => (*curvature, *twist),
        _ => ([0.0; 2], 0.0),
    };
    let at = |place: f64| {
        let own = section_at(sections, place);
        let own = own.map(|one| (one.section.natural_curvature, one.section.natural_twist));
        let (own_curvature, own_twist) = own.unwrap_or_default();
        (
            own_curvature.unwrap_or(curvature),
            own_twist.unwrap_or(twist),
        )
    };
    let nodes = places.len();
    let (mut curvatures, mut twists, mut halves) =
        (vec![[0.0; 2]; nodes], vec![0.0; nodes], vec![0.0; nodes]);
    for (edge, ends) in places.windows(2).enumerate() {
        let (start, end) = (ends[0], ends[1]);
        for [from, to] in pieces([start, end], joints) {
            let centre = 0.5 * (from + to);
            let (curvature, twist) = at(centre);
            let along = (centre - start) / (end - start);
            for (node, hat) in [(edge, 1.0 - along), (edge + 1, along)] {
                for axis in 0..2 {
                    curvatures[node][axis] += hat * curvature[axis] * (to - from);
                }
            }
            twists[edge + usize::from(along > 0.5)] += twist * (to - from);
        }
        halves[edge] += 0.5 * (end - start);
        halves[edge + 1] += 0.5 * (end - start);
    }
    let curvature = curvatures.iter().zip(&halves);
    NaturalStrains {
        lengths: lengths.to_vec(),
        curvature: curvature
            .map(|(sums, half)| sums.map(|sum| sum / half))
            .collect(),
        twist: twists
            .iter()
            .zip(&halves)
            .map(|(sum, half)| sum / half)
            .collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::super::prepare;
    use super::*;
    use rodlab_engine::mechanics::dynamics::Simulation;
    use rodlab_engine::mechanics::scene as mechanics;
    use rodlab_engine::mechanics::scene::RodDescription;

    const ROD: &str = "experiment = \"scene\"\n\
        material = { youngs_modulus = 1e9, poissons_ratio = 0.5, density = 1000.0 }\n\
        time = { mode = \"static\" }\n[[rods]]\nname = \"rod\"\nradius = 0.002\ndirector = [0, 0, 1]\n";
    const CLAMP: &str = "[[clamps]]\nrod = \"rod\"\nat = \"start\"\n";
    const LINE: &str = "shape = { kind = \"straight\", start = [0, 0, 0], end = [0.5, 0, 0] }\n";

    fn scene(lines: &str) -> Result<RodDescription, String> {
        let loaded = crate::test_support::loaded("rod", &format!("{ROD}{lines}"))
            .unwrap_or_else(|error| panic!("{error}"));
        let prepared = prepare(&loaded.scenario);
        let prepared = prepared.map_err(|issues| loaded.locate(issues).to_string())?;
        Ok(prepared.scene.rods[0].clone())
    }

    #[test]
    fn the_end_of_a_section_is_compared_with_the_length_of_the_curve() {
        let circle = "edges = 20\nshape = { kind = \"arc\", start = [0, 0, 0], tangent = [1, 0, 0], normal = [0, 0, 1], radius = 1, angle = \"90 deg\" }\n";
        let to = |to: f64| {
            scene(&format!(
                "{circle}[[rods.sections]]\nend_radius = 0.001\nto = {to}\n"
            ))
        };
        // The polygon is shorter than the arc.
        let quarter = std::f64::consts::FRAC_PI_2;
        let rod = to(quarter).unwrap();
        assert!(
            (rod.radius_at(20) - 1e-3).abs() < 1e-8,
            "{}",
            rod.radius_at(20)
        );
        assert!((rod.radius_at(10) - 1.5e-3).abs() < 1e-8);
        let message = to(quarter + 1e-3).unwrap_err();
        assert!(
            message.contains("rods.0.sections.0.to") && message.contains("1.570796 m"),
            "{message}"
        );
        let message = scene(&format!("edges = 4\n{LINE}[[rods.sections]]\nfrom = 0.5\n"));
        assert!(
            message
                .unwrap_err()
                .contains("less than the length of the rod, 0.500000 m")
        );
    }

    #[test]
    fn stiffnesses_that_are_given_change_in_proportion() {
        let halves =
            "[rods.stiffness]\ntwisting = 7.0\n[[rods.sections]]\nfrom = 0.25\nradius = 0.004\n";
        let rod = scene(&format!("edges = 2\n{LINE}{halves}")).unwrap();
        let [thin, thick] = [0, 1].map(|edge| rod.sections[edge].twisting[0]);
        assert!((thin / 7.0 - 1.0).abs() < 1e-12 && (thick / 7.0 / 16.0 - 1.0).abs() < 1e-12);
    }

    #[test]
    fn natural_curvature_of_a_part_bends_it_into_an_arc() {
        // Straight over 0.22 m, inside an edge, then an arc of radius 0.3 m; without loads.
        let end = |edges: usize| {
            let bent =
                "[[rods.sections]]\nfrom = 0.22\nnatural_curvature = [0, 3.3333333333333335]\n";
            let text = format!("{ROD}edges = {edges}\n{LINE}{bent}{CLAMP}");
            let loaded = crate::test_support::loaded("rod", &text).unwrap();
            let prepared = prepare(&loaded.scenario).unwrap();
            let mut simulation = Simulation::new(&prepared.scene, &prepared.integration).unwrap();
            simulation.find_equilibrium().unwrap();
            *simulation.positions().last().unwrap()
        };
        // The rod bends towards the first director.
        let angle: f64 = 0.28 / 0.3;
        let exact = Vector3::new(0.22 + 0.3 * angle.sin(), 0.0, 0.3 * (1.0 - angle.cos()));
        let [coarse, fine] = [20, 40].map(|edges| (end(edges) - exact).norm());
        assert!(fine < 2e-4 && coarse / fine > 3.5, "{coarse:e} {fine:e}");
    }

    #[test]
    fn natural_twist_of_a_part_is_counted_between_the_middles_of_edges() {
        let sections = "[[rods.sections]]\nfrom = 0.2\nto = 0.4\nnatural_twist = 3.0\n";
        let text = format!("edges = 4\nnatural_twist = 1.0\n{LINE}{sections}{CLAMP}");
        let rod = scene(&text).unwrap();
        let mechanics::NaturalShape::Strains(natural) = rod.natural_shape else {
            panic!("{:?}", rod.natural_shape);
        };
        let length = |node: usize| {
            if node.is_multiple_of(4) {
                0.0625
            } else {
                0.125
            }
        };
        let total: f64 = (0..5).map(|node| natural.twist[node] * length(node)).sum();
        assert!((total - (0.3 + 0.6)).abs() < 1e-12, "{total}");
        // Node 2 has 0.1875 to 0.3125.
        let expected = (0.0125 + 0.1125 * 3.0) / 0.125;
        assert!(
            (natural.twist[2] - expected).abs() < 1e-12,
            "{:?}",
            natural.twist
        );
    }
}
