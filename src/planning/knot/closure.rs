//! Closure of open curves, with their ends joined far away.

use rodlab_engine::mechanics::Vector3;

/// Distance outside the curves at which their ends are joined, in multiples of their extent.
const FAR: f64 = 20.0;

/// A rod with a path that joins its ends. The path leaves both ends along the line through them,
/// away from each other, and closes outside the rod's extent. For a rod pulled at both ends this
/// is the usual definition of its knot. `None` without nodes.
pub fn closed_far_away(nodes: &[Vector3]) -> Option<Vec<Vector3>> {
    let (first, last) = (nodes.first()?, nodes.last()?);
    let extent = extent(nodes.iter(), first);
    let along = (last - first)
        .try_normalize(1e-9 * extent)
        .unwrap_or_else(Vector3::x);
    let aside = along.cross(&Vector3::new(0.267, 0.535, 0.802));
    let aside = aside.try_normalize(1e-3).unwrap_or_else(Vector3::y);
    let out = FAR * extent;
    let mut closed = nodes.to_vec();
    closed.push(last + along * out);
    closed.push(last + along * out + aside * out);
    closed.push(first - along * out + aside * out);
    closed.push(first - along * out);
    Some(closed)
}

/// Two rods as one closed curve. Their ends are pulled along `axis`, two to each side. One path
/// joins the starts of the rods, another one their ends. Both paths leave the rods outwards along
/// the axis and close on opposite sides of it; the second path is on the side of the ends.
pub fn joined_far_away(rods: [&[Vector3]; 2], axis: &Vector3) -> Option<Vec<Vector3>> {
    let starts = [*rods[0].first()?, *rods[1].first()?];
    let ends = [*rods[0].last()?, *rods[1].last()?];
    let middle = (starts[0] + starts[1] + ends[0] + ends[1]) / 4.0;
    let far = FAR * extent(rods.into_iter().flatten(), &middle);
    let outside = |end: &Vector3| end + axis * far.copysign((end - middle).dot(axis));
    let apart = ends[0] + ends[1] - starts[0] - starts[1];
    let aside = (apart - axis * apart.dot(axis)).try_normalize(0.0)? * far;
    let mut closed = rods[0].to_vec();
    closed.extend([
        outside(&ends[0]),
        outside(&ends[0]) + aside,
        outside(&ends[1]) + aside,
        outside(&ends[1]),
    ]);
    closed.extend(rods[1].iter().rev());
    closed.extend([
        outside(&starts[1]),
        outside(&starts[1]) - aside,
        outside(&starts[0]) - aside,
        outside(&starts[0]),
    ]);
    Some(closed)
}

fn extent<'a>(nodes: impl Iterator<Item = &'a Vector3>, from: &Vector3) -> f64 {
    nodes.map(|node| (node - from).norm()).fold(0.0, f64::max)
}
