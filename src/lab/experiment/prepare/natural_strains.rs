//! Natural strains over the arc length, at the nodes of a rod.

use crate::scenario::Strains;
use rodlab_engine::mechanics::scene::NaturalStrains;

/// The strains of a rod with a number of edges: the rows themselves if there is one for each node,
/// else interpolated at nodes of equal distances.
pub(super) fn at_nodes(strains: &Strains, edges: usize) -> NaturalStrains {
    let rows = &strains.arc_length;
    if rows.len() == edges + 1 {
        return NaturalStrains {
            lengths: rows.windows(2).map(|pair| pair[1] - pair[0]).collect(),
            curvature: (strains.curvature_1.iter().zip(&strains.curvature_2))
                .map(|(one, other)| [*one, *other])
                .collect(),
            twist: strains.twist.clone(),
        };
    }
    let length = rows.last().copied().unwrap_or(0.0) / edges as f64;
    let at = |list: &[f64], node: usize| {
        let place = length * node as f64;
        let after = rows.partition_point(|row| *row < place);
        let after = after.clamp(1, rows.len() - 1);
        let part = (place - rows[after - 1]) / (rows[after] - rows[after - 1]);
        (1.0 - part) * list[after - 1] + part * list[after]
    };
    let nodes = 0..=edges;
    NaturalStrains {
        lengths: vec![length; edges],
        curvature: nodes
            .clone()
            .map(|node| {
                [
                    at(&strains.curvature_1, node),
                    at(&strains.curvature_2, node),
                ]
            })
            .collect(),
        twist: nodes.map(|node| at(&strains.twist, node)).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_nodes_or_are_interpolated() {
        let strains = Strains {
            arc_length: vec![0.0, 0.1, 0.4],
            curvature_1: vec![0.0, 1.0, 4.0],
            curvature_2: vec![2.0, 2.0, 2.0],
            twist: vec![0.0, 0.0, 3.0],
        };
        let own = at_nodes(&strains, 2);
        assert!((own.lengths[1] - 0.3).abs() < 1e-15 && own.curvature[1] == [1.0, 2.0]);
        let finer = at_nodes(&strains, 4);
        assert_eq!(finer.lengths, [0.1; 4]);
        assert!((finer.curvature[3][0] - 3.0).abs() < 1e-12, "{finer:?}");
        assert!((finer.twist[2] - 1.0).abs() < 1e-12 && finer.twist[4] == 3.0);
    }
}
