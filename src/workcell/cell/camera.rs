//! The camera of a cell, prepared to locate points on the table.

use super::resolved::{Camera, Cell};
use rodlab_vision::Lens;

impl Camera {
    /// Returns a camera that locates pixels on the plane z = `height`, m.
    pub fn seeing(&self, height: f64) -> rodlab_vision::Camera {
        let [width, height_px] = self.size;
        let [fx, fy, cx, cy] = self.intrinsics;
        let mut distortion = [0.0; 5];
        for (slot, given) in distortion.iter_mut().zip(&self.distortion) {
            *slot = *given;
        }
        rodlab_vision::Camera {
            width,
            height: height_px,
            lens: Lens {
                focal: [fx, fy],
                centre: [cx, cy],
                distortion,
            },
            pose: self.pose,
            table_height: height,
        }
    }
}

impl Cell {
    /// Height of the top of the table at its middle, m; 0 without a table.
    pub fn table_height(&self) -> f64 {
        self.table.map_or(0.0, |table| table.top.translation.z)
    }
}
