//! Contact maps: where rods are pressed, over time.

use rodlab_files::figure::{ColourField, Figure, LinePlot, line_plots};
use rodlab_files::results::PressedNode;
use std::collections::BTreeMap;

/// Most rods in a figure: those with the largest forces.
const MOST_RODS: usize = 6;

/// The normal forces on the nodes of rods over time, a plot per rod; `None` without contact.
pub fn contact_map(pressed: &[PressedNode]) -> Option<Figure> {
    // Sums over the contacts of each node at each time. Times are those of a file, so that equal
    // ones have equal bits.
    let mut rods: BTreeMap<&str, BTreeMap<(u64, usize), f64>> = BTreeMap::new();
    for one in pressed {
        let forces = rods.entry(&one.rod).or_default();
        *forces.entry((one.time.to_bits(), one.node)).or_default() += one.normal_force;
    }
    let largest =
        |forces: &BTreeMap<(u64, usize), f64>| forces.values().copied().fold(0.0, f64::max);
    let mut rods: Vec<_> = rods.into_iter().collect();
    rods.sort_by(|one, other| largest(&other.1).total_cmp(&largest(&one.1)));
    rods.truncate(MOST_RODS);
    let plots: Vec<LinePlot> = (rods.into_iter())
        .map(|(rod, forces)| {
            let values = forces.into_iter();
            let values =
                values.map(|((time, node), force)| [f64::from_bits(time), node as f64, force]);
            let field = ColourField {
                label: "Normal force in N".into(),
                values: values.collect(),
                ..ColourField::default()
            };
            LinePlot {
                field: Some(field),
                ..LinePlot::new(format!("Node of {rod}"), [])
            }
        })
        .collect();
    (!plots.is_empty()).then(|| line_plots(plots, "Time in s"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn forces_on_a_node_at_one_time_are_added_up() {
        let at = |rod: &str, time: f64, node, normal_force| PressedNode {
            time,
            rod: rod.into(),
            node,
            normal_force,
        };
        assert_eq!(contact_map(&[]), None);
        let pressed = [
            at("light", 0.1, 3, 0.5),
            at("wire", 0.2, 7, 1.0),
            at("wire", 0.2, 7, 2.0),
            at("wire", 0.1, 7, 1.0),
        ];
        let Some(Figure::Lines(figure)) = contact_map(&pressed) else {
            panic!("a figure");
        };
        let plots = figure.plots();
        let values = |plot: &LinePlot| plot.field.clone().unwrap().values;
        assert_eq!(plots[0].label, "Node of wire");
        assert_eq!(values(&plots[0]), [[0.1, 7.0, 1.0], [0.2, 7.0, 3.0]]);
        assert_eq!(values(&plots[1]), [[0.1, 3.0, 0.5]]);
    }
}
