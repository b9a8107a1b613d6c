//! Surroundings of the arms of a cell, for collision checks.

use super::resolved::Cell;
use nalgebra::Translation3;
use rodlab_robot::{Member, StandingBox, Surroundings};

impl Cell {
    /// The arms, the table and the obstacles.
    pub fn surroundings(&self) -> Surroundings {
        let members = self.arms.iter().map(|arm| Member {
            name: arm.name.clone(),
            chain: arm.chain.clone(),
            base: arm.base,
            bodies: arm.bodies.clone(),
            home: arm.home.clone(),
            may_touch: arm.may_touch.clone(),
        });
        Surroundings::new(members.collect(), self.boxes())
    }

    /// The table and the obstacles.
    pub(super) fn boxes(&self) -> Vec<StandingBox> {
        let table = self.table.map(|table| {
            let half = table.size.map(|side| side / 2.0);
            StandingBox {
                name: "table".into(),
                pose: table.top * Translation3::new(0.0, 0.0, -half[2]),
                half,
            }
        });
        let obstacles = self.obstacles.iter().map(|obstacle| StandingBox {
            name: obstacle.name.clone(),
            pose: obstacle.pose,
            half: obstacle.size.map(|side| side / 2.0),
        });
        table.into_iter().chain(obstacles).collect()
    }
}
