//! Test joints of the proofs: 3, 4 and 5 planets, both damping laws, with and without compliance, mesh phase by angle
//! and by time, equal, unequal and no backlash, and an equivalent gear. Each is a preset with a few values changed.

use std::fs;
use std::path::{Path, PathBuf};

use joint_file::JointFile;

use board::device::cross_build::cannot_write;
use report::failure::{Failure, Outcome};

/// Joint on which the step is tested.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TestJoint {
    /// Name in every table.
    pub name: &'static str,
    preset: &'static str,
    changes: &'static [(&'static str, &'static str)],
}

/// All test joints.
pub const TEST_JOINTS: [TestJoint; 6] = [
    TestJoint { name: "Q1", preset: "q1", changes: &[] },
    TestJoint { name: "paper", preset: "paper", changes: &[] },
    TestJoint {
        name: "L1 with 4 planets",
        preset: "l1",
        changes: &[("coherence", "warn"), ("planets", "4"), ("mesh.half_backlash_um", "[60.0, 45.0, 30.0, 15.0]")],
    },
    TestJoint {
        name: "S1 without backlash",
        preset: "s1",
        changes: &[("coherence", "warn"), ("planets", "4"), ("mesh.half_backlash_um", "0.0")],
    },
    TestJoint {
        name: "Q1 with 5 planets",
        preset: "q1",
        // A larger sun leaves room for five planets.
        changes: &[
            ("coherence", "warn"),
            ("planets", "5"),
            ("sun_teeth", "30"),
            ("ring_teeth", "90"),
            ("damping_law", "paper"),
            ("mesh.half_backlash_um", "[40.0, 30.0, 20.0, 10.0, 0.0]"),
        ],
    },
    // Equivalent gear with a contact that is fast compared with a tick.
    TestJoint { name: "C1", preset: "c1", changes: &[("equivalent_gear.total_stiffness_N_m_per_arcmin", "6000")] },
];

impl TestJoint {
    /// Text of the joint file.
    pub fn text(&self) -> Outcome<String> {
        let preset = joint_file::preset(self.preset);
        let start = preset.ok_or_else(|| Failure::new(format!("there is no preset {}", self.preset)))?;
        let named = [("name", self.name)];
        named.iter().chain(self.changes).try_fold(start.to_owned(), |text, (key, value)| {
            joint_file::change(&text, key, value)
                .map_err(|refused| Failure::new(refused.message).with_help(refused.help))
        })
    }

    /// Parsed joint file.
    pub fn read(&self) -> Outcome<JointFile> {
        joint_file::read(&self.text()?).map_err(|problems| {
            let list: Vec<_> = problems.iter().map(ToString::to_string).collect();
            Failure::new(format!("joint {}: {}", self.name, list.join("\n")))
        })
    }
}

/// Writes the files of all test joints below a folder, for the firmware's build.
pub fn write_files(folder: &Path) -> Outcome<Vec<PathBuf>> {
    let folder = folder.join("trial-joints");
    let write = |(index, joint): (usize, &TestJoint)| {
        let (path, text) = (folder.join(format!("{index}.toml")), joint.text()?);
        // An unchanged file is not rewritten, so that nothing is rebuilt.
        if fs::read_to_string(&path).is_ok_and(|found| found == text) {
            return Ok(path);
        }
        let written = fs::create_dir_all(&folder).and_then(|()| fs::write(&path, text));
        written.map_err(|error| cannot_write(&path, &error))?;
        Ok(path)
    };
    TEST_JOINTS.iter().enumerate().map(write).collect()
}

#[cfg(test)]
mod tests {
    use parameters::DampingLaw;

    use super::*;

    /// The test joints cover all numbers of planets, damping laws, compliances and backlashes.
    #[test]
    fn test_joints_cover_all_features() {
        let joints: Vec<_> = TEST_JOINTS.iter().map(|joint| joint.read().unwrap().parameters).collect();
        let any = |has: &dyn Fn(&parameters::JointParameters) -> bool| joints.iter().any(has);
        for planets in 3..=5 {
            assert!(any(&|joint| joint.geometry.planets == planets));
        }
        for law in [DampingLaw::Paper, DampingLaw::Contact] {
            assert!(any(&|joint| joint.damping_law == law));
        }
        assert!(any(&|joint| joint.compliance.is_some()) && any(&|joint| joint.compliance.is_none()));
        assert!(any(&|joint| joint.sun_planet.half_backlash.iter().all(|half| *half == 0.0)));
        assert!(any(&|joint| joint.sun_planet.half_backlash[0] != joint.sun_planet.half_backlash[1]));
    }
}
