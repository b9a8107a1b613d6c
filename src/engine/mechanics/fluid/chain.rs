//! Order of nodes along the filaments, and runs of them in the layout of the segment kernel.

use super::Filament;

/// A node in the sequence of the nodes of all filaments, one filament after the other.
#[derive(Clone, Copy, Debug)]
pub(super) struct Link {
    /// The node before it on the same filament.
    pub previous: Option<usize>,
    /// The node after it.
    pub next: Option<usize>,
    /// ε² of the filament, m².
    pub regularization_squared: f64,
}

/// The links of all nodes; ε is `regularization` times each filament's radius.
pub(super) fn links(filaments: &[Filament], regularization: f64) -> Vec<Link> {
    let mut links = Vec::new();
    for filament in filaments {
        let (first, last) = (links.len(), filament.nodes - 1);
        let epsilon = regularization * filament.radius;
        links.extend((0..filament.nodes).map(|k| Link {
            previous: match k {
                0 => filament.closed.then_some(first + last),
                _ => Some(first + k - 1),
            },
            next: match k {
                k if k == last => filament.closed.then_some(first),
                _ => Some(first + k + 1),
            },
            regularization_squared: epsilon * epsilon,
        }));
    }
    links
}

/// A place in a row of slots.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Slot {
    /// The node here.
    pub node: usize,
    /// Whether the node was requested; if not, it only ends a segment of its neighbour.
    pub own: bool,
    /// Whether a segment runs from here to the next slot.
    pub joined: bool,
}

/// Lays out nodes, in ascending order, so that every segment that ends at one of them runs between
/// consecutive slots. No slot with `own` follows a segment that is not its own.
pub(super) fn lay_out(links: &[Link], nodes: &[usize], slots: &mut Vec<Slot>) {
    slots.clear();
    let slot = |node, own, joined| Slot { node, own, joined };
    let mut continued = false;
    for (k, &node) in nodes.iter().enumerate() {
        let Link { previous, next, .. } = links[node];
        if let (false, Some(previous)) = (continued, previous) {
            slots.push(slot(previous, false, true));
        }
        slots.push(slot(node, true, next.is_some()));
        continued = next.is_some() && nodes.get(k + 1).copied() == next;
        if let (false, Some(next)) = (continued, next) {
            slots.push(slot(next, false, false));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn filament(nodes: usize, closed: bool) -> Filament {
        Filament {
            first_node: 0,
            nodes,
            closed,
            radius: 1.0,
        }
    }

    fn layout(nodes: &[usize]) -> Vec<(usize, bool, bool)> {
        let links = links(&[filament(4, false), filament(3, true)], 1.0);
        let mut slots = Vec::new();
        lay_out(&links, nodes, &mut slots);
        (slots.iter().map(|s| (s.node, s.own, s.joined))).collect()
    }

    #[test]
    fn runs_carry_their_neighbours() {
        assert_eq!(
            layout(&[0, 2, 3]),
            [
                (0, true, true),
                (1, false, false),
                (1, false, true),
                (2, true, true),
                (3, true, false),
            ]
        );
    }

    #[test]
    fn a_ring_is_joined_at_both_ends() {
        assert_eq!(
            layout(&[4, 5, 6]),
            [
                (6, false, true),
                (4, true, true),
                (5, true, true),
                (6, true, true),
                (4, false, false),
            ]
        );
    }
}
