//! Writes each output time to all files that grow during a run.

use super::contacts::write_contacts;
use super::files::{
    CONTACTS, NODE_FORCES, NODES, OBSTACLE_FRAMES, SERIES, VTK_FOLDER, frame_name,
    obstacle_frame_name,
};
use super::forces::write_forces;
use super::frame::Frame;
use super::mark::{FileMark, FileMarks, Marker, marked_frames};
use super::nodes::write_nodes;
use super::obstacle_frames::{ObstacleFrames, ObstacleSurfaces};
use super::stream::CsvStream;
use super::{ResultsError, RodRecord, SeriesRow, Value, vtk};
use std::path::{Path, PathBuf};

/// Files that a run writes in addition to `series.csv`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RecorderPlan {
    /// Names of the columns that observers add to `series.csv`.
    pub observed: Vec<String>,
    /// `nodes.csv`.
    pub nodes: bool,
    /// `node_forces.csv`.
    pub forces: bool,
    /// `contacts.csv`.
    pub contacts: bool,
    /// `vtk/` and `rods.pvd`.
    pub vtk: bool,
    /// Writer for the obstacles in `vtk/`.
    pub obstacles: Option<ObstacleSurfaces>,
}

/// The files of a run that grow.
pub struct Recorder {
    directory: PathBuf,
    rods: Vec<RodRecord>,
    series: CsvStream,
    observed: Vec<String>,
    nodes: Option<CsvStream>,
    forces: Option<CsvStream>,
    contacts: Option<CsvStream>,
    /// Mark of the frames written so far.
    frames: Option<Marker>,
    obstacles: Option<ObstacleFrames>,
}

impl Recorder {
    /// Creates all files.
    pub fn create(
        directory: &Path,
        rods: Vec<RodRecord>,
        plan: RecorderPlan,
    ) -> Result<Self, ResultsError> {
        let stream = |name: &str| CsvStream::create(&directory.join(name));
        Ok(Self {
            series: stream(SERIES)?,
            observed: plan.observed,
            nodes: plan.nodes.then(|| stream(NODES)).transpose()?,
            forces: plan.forces.then(|| stream(NODE_FORCES)).transpose()?,
            contacts: plan.contacts.then(|| stream(CONTACTS)).transpose()?,
            frames: plan.vtk.then(Marker::default),
            obstacles: plan
                .obstacles
                .filter(|_| plan.vtk)
                .map(|obstacles| ObstacleFrames::after(obstacles, Marker::default())),
            directory: directory.to_owned(),
            rods,
        })
    }

    /// Continues all files from the marks of a checkpoint; later data is dropped.
    ///
    /// # Errors
    /// [`ResultsError::Altered`] if a file differs from its state at the checkpoint.
    pub fn continue_at(
        directory: &Path,
        rods: Vec<RodRecord>,
        plan: RecorderPlan,
        marks: &FileMarks,
    ) -> Result<Self, ResultsError> {
        let nothing = FileMark::default();
        let marked = |name: &str| marks.get(name).unwrap_or(&nothing);
        let stream = |name: &str| CsvStream::continue_at(&directory.join(name), marked(name));
        let frames = || marked_frames(directory, marked(VTK_FOLDER), frame_name);
        let obstacles = |obstacles| {
            let mark = marked(OBSTACLE_FRAMES);
            let marker = marked_frames(directory, mark, obstacle_frame_name)?;
            Ok(ObstacleFrames::after(obstacles, marker))
        };
        Ok(Self {
            series: stream(SERIES)?,
            observed: plan.observed,
            nodes: plan.nodes.then(|| stream(NODES)).transpose()?,
            forces: plan.forces.then(|| stream(NODE_FORCES)).transpose()?,
            contacts: plan.contacts.then(|| stream(CONTACTS)).transpose()?,
            frames: plan.vtk.then(frames).transpose()?,
            obstacles: plan
                .obstacles
                .filter(|_| plan.vtk)
                .map(obstacles)
                .transpose()?,
            directory: directory.to_owned(),
            rods,
        })
    }

    /// Whether the frames must hold velocities and forces.
    pub fn needs_forces(&self) -> bool {
        self.forces.is_some() || self.frames.is_some()
    }

    /// Whether the frames must hold contacts.
    pub fn needs_contacts(&self) -> bool {
        self.contacts.is_some()
    }

    /// Whether the frames must hold the poses of obstacles.
    pub fn needs_obstacle_poses(&self) -> bool {
        self.obstacles
            .as_ref()
            .is_some_and(ObstacleFrames::need_poses)
    }

    /// Whether frames are written at all.
    pub fn needs_frames(&self) -> bool {
        self.nodes.is_some() || self.needs_forces() || self.needs_contacts()
    }

    /// Writes output number `index`, which readers can then see. `observed` are the values of the
    /// columns that observers add to the series.
    pub fn record(
        &mut self,
        index: usize,
        row: &SeriesRow,
        observed: &[Value],
        frame: &Frame,
    ) -> Result<(), ResultsError> {
        if let Some(nodes) = &mut self.nodes {
            write_nodes(nodes, &self.rods, frame)?;
        }
        if let Some(forces) = &mut self.forces {
            write_forces(forces, &self.rods, frame)?;
        }
        if let Some(contacts) = &mut self.contacts {
            write_contacts(contacts, frame)?;
        }
        if let Some(frames) = &mut self.frames {
            frames.update(&vtk::write_frame(
                &self.directory,
                index,
                &self.rods,
                frame,
            )?);
        }
        if let Some(obstacles) = &mut self.obstacles {
            obstacles.write(&self.directory, index, frame)?;
        }
        // Written last, so that a time in the series exists in all files.
        self.series.write_with(row, &self.observed, observed)?;
        self.series.flush()
    }

    /// Syncs all files to the disk and marks them; `times` are those of all outputs so far.
    ///
    /// # Errors
    /// [`ResultsError::Altered`] if one was removed or replaced meanwhile, [`ResultsError::Io`].
    pub fn sync(&mut self, times: impl Iterator<Item = f64>) -> Result<FileMarks, ResultsError> {
        let mut marks = FileMarks::from([(SERIES.to_owned(), self.series.sync()?)]);
        for (name, stream) in [
            (NODES, &mut self.nodes),
            (NODE_FORCES, &mut self.forces),
            (CONTACTS, &mut self.contacts),
        ] {
            if let Some(stream) = stream {
                marks.insert(name.to_owned(), stream.sync()?);
            }
        }
        if let Some(frames) = &self.frames {
            let file = |index| Some(self.obstacles.as_ref()?.file(index));
            vtk::write_collection(&self.directory, times, file)?;
            marks.insert(VTK_FOLDER.to_owned(), frames.mark());
        }
        if let Some(obstacles) = &self.obstacles {
            marks.insert(OBSTACLE_FRAMES.to_owned(), obstacles.mark());
        }
        Ok(marks)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::results::{ContactRecord, Surface, check_files, read_series_as};
    use nalgebra::{Isometry3, Vector3};
    use serde::Deserialize;
    use std::fs;

    fn rods() -> Vec<RodRecord> {
        let rod = |name: &str, nodes, closed| RodRecord {
            name: name.into(),
            nodes,
            closed,
            radius: 1e-3,
            ..RodRecord::default()
        };
        vec![rod("beam", 2, false), rod("ring, \"red\"", 3, true)]
    }

    fn frame(time: f64) -> Frame {
        Frame {
            time,
            twist_rates: vec![2.5; 5],
            positions: (0..5)
                .map(|k| Vector3::new(time, k as f64 / 8.0, 1e-9))
                .collect(),
            edge_angles: vec![0.5; 5],
            velocities: vec![Vector3::x(); 5],
            fluid_forces: Vec::new(),
            contact_forces: vec![Vector3::new(0.0, -2e-3, 0.0); 5],
            contacts: vec![ContactRecord {
                names: ["beam".into(), "plane 0".into()],
                nodes: [Some(1), None],
                place: Vector3::new(0.0, 0.125, -1e-3),
                normal: Vector3::z(),
                gap: 1e-5,
                normal_force: 2e-3,
                friction: Vector3::new(time, 0.0, 0.0),
            }],
            obstacle_poses: vec![Isometry3::translation(time, 0.0, 0.0)],
        }
    }

    fn row(time_s: f64) -> SeriesRow {
        SeriesRow {
            time_s,
            contacts: Some(2),
            ..SeriesRow::default()
        }
    }

    fn all() -> RecorderPlan {
        RecorderPlan {
            observed: Vec::new(),
            nodes: true,
            forces: true,
            contacts: true,
            vtk: true,
            obstacles: Some(ObstacleSurfaces {
                surfaces: vec![Surface {
                    points: vec![Vector3::zeros(), Vector3::x(), Vector3::y()],
                    triangles: vec![[0, 1, 2]],
                }],
                moving: true,
            }),
        }
    }

    #[test]
    fn columns_and_rows_are_those_of_the_contract() {
        let directory = tempfile::tempdir().unwrap();
        let mut recorder = Recorder::create(directory.path(), rods(), all()).unwrap();
        recorder.record(0, &row(0.0), &[], &frame(0.0)).unwrap();
        recorder.record(1, &row(0.1), &[], &frame(0.1)).unwrap();
        let read = |name: &str| fs::read_to_string(directory.path().join(name)).unwrap();
        assert_eq!(
            read(SERIES),
            "time_s,step_s,steps,newton_iterations,fluid_iterations,contacts,min_distance_m,\
             kinetic_energy_j,stretching_energy_j,bending_energy_j,twisting_energy_j,contact_energy_j,\
             gravitational_energy_j\n\
             0.0,,0,,,2,,0.0,0.0,0.0,0.0,0.0,0.0\n\
             0.1,,0,,,2,,0.0,0.0,0.0,0.0,0.0,0.0\n"
        );
        let nodes = read(NODES);
        let lines: Vec<_> = nodes.lines().collect();
        assert_eq!(lines.len(), 11);
        assert_eq!(lines[0], "time_s,rod,node,x_m,y_m,z_m,theta_rad");
        assert_eq!(lines[1], "0.0,beam,0,0.0,0.0,1e-9,0.5");
        assert_eq!(lines[2], "0.0,beam,1,0.0,0.125,1e-9,");
        assert_eq!(lines[10], "0.1,\"ring, \"\"red\"\"\",2,0.1,0.5,1e-9,0.5");
        let forces = read(NODE_FORCES);
        assert_eq!(
            forces.lines().nth(1),
            Some("0.0,beam,0,1.0,0.0,0.0,0.0,0.0,0.0,0.0,-0.002,0.0,2.5")
        );
        let contacts = read(CONTACTS);
        let header = "time_s,first,first_node,second,second_node,x_m,y_m,z_m,normal_x,normal_y,normal_z,gap_m,normal_force_n,friction_x_n,friction_y_n,friction_z_n";
        assert_eq!(contacts.lines().next(), Some(header));
        assert_eq!(
            contacts.lines().nth(2),
            Some("0.1,beam,1,plane 0,,0.0,0.125,-0.001,0.0,0.0,1.0,0.00001,0.002,0.1,0.0,0.0")
        );
    }

    #[test]
    fn observers_add_columns_that_are_read_by_their_names() {
        #[derive(Debug, PartialEq, Deserialize)]
        struct Tip {
            tip_z_m: Option<f64>,
            time_s: f64,
            turns: u64,
        }
        let directory = tempfile::tempdir().unwrap();
        let plan = RecorderPlan {
            observed: vec!["turns".into(), "tip_z_m".into()],
            ..RecorderPlan::default()
        };
        let mut recorder = Recorder::create(directory.path(), rods(), plan).unwrap();
        for (k, tip) in [None, Some(0.25)].into_iter().enumerate() {
            let observed = [Value::from(3_u64), Value::from(tip)];
            let row = row(k as f64);
            recorder
                .record(k, &row, &observed, &Frame::default())
                .unwrap();
        }
        let text = fs::read_to_string(directory.path().join(SERIES)).unwrap();
        let lines: Vec<&str> = text.lines().collect();
        assert!(lines[0].ends_with(",gravitational_energy_j,turns,tip_z_m"));
        assert!(lines[1].ends_with(",0.0,3,"), "{}", lines[1]);
        assert!(lines[2].ends_with(",0.0,3,0.25"), "{}", lines[2]);
        let read: Vec<Tip> = read_series_as(directory.path()).unwrap();
        let tip = |time_s, tip_z_m| Tip {
            tip_z_m,
            time_s,
            turns: 3,
        };
        assert_eq!(read, [tip(0.0, None), tip(1.0, Some(0.25))]);
    }

    #[test]
    fn continued_files_equal_files_written_in_a_go() {
        let (whole, cut) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
        let mut recorder = Recorder::create(whole.path(), rods(), all()).unwrap();
        for k in 0..4 {
            recorder
                .record(k, &row(k as f64), &[], &frame(k as f64))
                .unwrap();
        }
        recorder.sync((0..4).map(|k| k as f64)).unwrap();

        let mut recorder = Recorder::create(cut.path(), rods(), all()).unwrap();
        recorder.record(0, &row(0.0), &[], &frame(0.0)).unwrap();
        let marks = recorder.sync([0.0].into_iter()).unwrap();
        recorder.record(1, &row(77.0), &[], &frame(77.0)).unwrap();
        drop(recorder);
        let mut recorder = Recorder::continue_at(cut.path(), rods(), all(), &marks).unwrap();
        for k in 1..4 {
            recorder
                .record(k, &row(k as f64), &[], &frame(k as f64))
                .unwrap();
        }
        recorder.sync((0..4).map(|k| k as f64)).unwrap();
        for name in [
            SERIES,
            NODES,
            NODE_FORCES,
            CONTACTS,
            "rods.pvd",
            "vtk/rods_000001.vtp",
            "vtk/obstacles_000001.vtp",
        ] {
            let read =
                |directory: &tempfile::TempDir| fs::read(directory.path().join(name)).unwrap();
            assert_eq!(read(&whole), read(&cut), "{name}");
        }
    }

    #[test]
    fn obstacles_that_stand_are_written_once_and_those_that_move_at_every_time() {
        for (moving, written) in [(false, 1), (true, 3)] {
            let directory = tempfile::tempdir().unwrap();
            let obstacles = all().obstacles.map(|obstacles| ObstacleSurfaces {
                moving,
                ..obstacles
            });
            let plan = RecorderPlan { obstacles, ..all() };
            let mut recorder = Recorder::create(directory.path(), rods(), plan.clone()).unwrap();
            recorder.record(0, &row(0.0), &[], &frame(0.0)).unwrap();
            let marks = recorder.sync([0.0].into_iter()).unwrap();
            drop(recorder);
            let continued = Recorder::continue_at(directory.path(), rods(), plan, &marks);
            let mut recorder = continued.unwrap();
            for k in 1..3 {
                let frame = frame(k as f64);
                recorder.record(k, &row(k as f64), &[], &frame).unwrap();
            }
            let marks = recorder.sync((0..3).map(|k| k as f64)).unwrap();
            check_files(directory.path(), &marks).unwrap();
            let folder = fs::read_dir(directory.path().join(VTK_FOLDER)).unwrap();
            let names = folder.map(|entry| entry.unwrap().file_name().into_string().unwrap());
            let found = names.filter(|name| name.starts_with("obstacles_")).count();
            assert_eq!(found, written);
            let collection = fs::read_to_string(directory.path().join("rods.pvd")).unwrap();
            let last = format!(
                "<DataSet timestep=\"2.0\" part=\"1\" file=\"vtk/obstacles_00000{}.vtp\"/>",
                written - 1
            );
            assert!(collection.contains(&last), "{collection}");
            if moving {
                // In frame k the obstacles are k metres further along x.
                let first = |frame: usize| {
                    let name = format!("vtk/obstacles_{frame:06}.vtp");
                    let bytes = fs::read(directory.path().join(name)).unwrap();
                    let text = String::from_utf8_lossy(&bytes);
                    let (_, rest) = text.split_once("Name=\"points\"").unwrap();
                    let (_, rest) = rest.split_once("offset=\"").unwrap();
                    let offset: usize = rest.split_once('"').unwrap().0.parse().unwrap();
                    let data = bytes.windows(2).position(|pair| pair == b"\n_").unwrap() + 2;
                    let at = data + offset + 8;
                    f64::from_le_bytes(bytes[at..at + 8].try_into().unwrap())
                };
                assert_eq!([0, 1, 2].map(first), [0.0, 1.0, 2.0]);
            }
            fs::write(directory.path().join("vtk/obstacles_000000.vtp"), "no VTK").unwrap();
            check_files(directory.path(), &marks).unwrap_err();
        }
    }

    #[test]
    fn a_missing_frame_and_a_garbled_one_are_noticed_on_continuing() {
        let directory = tempfile::tempdir().unwrap();
        let mut recorder = Recorder::create(directory.path(), rods(), all()).unwrap();
        for k in 0..3 {
            recorder
                .record(k, &row(k as f64), &[], &frame(k as f64))
                .unwrap();
        }
        let marks = recorder.sync((0..3).map(|k| k as f64)).unwrap();
        check_files(directory.path(), &marks).unwrap();
        let path = directory.path().join("vtk/rods_000001.vtp");
        let whole = fs::read(&path).unwrap();
        let mut garbled = whole.clone();
        *garbled.last_mut().unwrap() ^= 1;
        for (bytes, what) in [
            (None, "rods_000001.vtp` is missing"),
            (Some(&garbled), "vtk` does not hold"),
        ] {
            fs::remove_file(&path).unwrap();
            if let Some(bytes) = bytes {
                fs::write(&path, bytes).unwrap();
            }
            let continued = Recorder::continue_at(directory.path(), rods(), all(), &marks);
            let checked = check_files(directory.path(), &marks);
            for error in [continued.err().unwrap(), checked.unwrap_err()] {
                assert!(error.to_string().contains(what), "{error}");
            }
            fs::write(&path, &whole).unwrap();
        }
        Recorder::continue_at(directory.path(), rods(), all(), &marks).unwrap();
    }
}
