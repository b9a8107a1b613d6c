//! Dense elements of the positions of nodes.

use crate::linalg::{Element, UNUSED};
use crate::mechanics::rod::STRIDE;

/// The element of the positions of up to four nodes.
pub(super) fn element_of(nodes: &[usize]) -> Element {
    let mut element = [UNUSED; 12];
    for (corner, node) in nodes.iter().enumerate() {
        for axis in 0..3 {
            element[3 * corner + axis] = STRIDE * node + axis;
        }
    }
    element
}
