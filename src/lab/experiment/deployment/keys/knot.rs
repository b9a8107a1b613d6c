//! Resolves a knot that is tied along the pattern.

use super::resolved::{Knot, Rod, Second};
use super::typed;
use crate::scenario::keys::Section;
use rodlab_planning::plan::deployment::DeployedRod;
use rodlab_planning::plan::pattern::Pattern;
use rodlab_planning::plan::tying::{Handling, TiedRod, passages};

/// The knot of a deployment, if there is one; `None` after a fault.
pub fn resolve(
    section: &Section<'_>,
    typed: &typed::Deployment,
    first: (&Rod, &Pattern),
    second: Option<&(Second, Pattern)>,
) -> Option<Option<Knot>> {
    let Some(knot) = &typed.knot else {
        return Some(None);
    };
    if typed.correction.is_some() {
        let message = "no knot can be tied along a path that is corrected while the rod is laid: leave `correction` out";
        section.fault("knot", message);
        return None;
    }
    let section = section.below("knot");
    let help = "\"over\" or \"under\" for each crossing, as [\"over\", \"under\", \"over\"]";
    let crossings = section.needed("crossings", knot.crossings.clone(), help)?;
    let second = second.map(|(second, curve)| (&second.rod, curve));
    let layings = || std::iter::once(first).chain(second);
    let rods: Vec<DeployedRod> = layings().map(|(rod, _)| rod.deployed()).collect();
    let tied = rods.iter().zip(layings());
    let tied: Vec<TiedRod> = tied
        .map(|(rod, (_, curve))| TiedRod { rod, curve })
        .collect();
    if let Err(error) = passages(&tied, &crossings) {
        section.fault("crossings", error.to_string());
        return None;
    }
    let usual = Handling::usual(&rods);
    let lift = knot.lift(&section, usual.lift);
    let speed = knot.speed(&section, usual.speed);
    let reach = knot.reach(&section);
    let is_known = [lift, speed, reach].iter().all(|value| value.is_finite());
    is_known.then_some(Some(Knot {
        crossings,
        lift,
        speed,
        reach,
    }))
}
