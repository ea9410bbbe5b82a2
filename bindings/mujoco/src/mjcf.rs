//! A model in MuJoCo's format with the joint on a stand: its parts are what a user's model needs.

use joint_file::JointFile;
use model_core::gears::{Kinematics, Mechanics};
use report::escape::escaped_xml;

/// Acceleration of gravity in the model [m/s2].
const GRAVITY: f64 = 9.81;
/// Inertia of a link that has none in the joint file [kg m2]: MuJoCo needs one.
const LEAST_INERTIA: f64 = 1e-6;

/// Model of the joint with its link on a stand. Friction, weight and inertia of the link are MuJoCo's; without compliance the
/// carrier is part of the link, as its armature.
pub fn model(joint: &JointFile, plugin: &str, file: &str) -> String {
    let (parameters, around) = (&joint.parameters, &joint.surroundings);
    let inertia = parameters.link_inertia.max(LEAST_INERTIA);
    let weight = around.gravity_torque.abs();
    // Half of the inertia comes from the distance of the weight, the other half from its extent.
    let (mass, arm) = match weight > 0.0 {
        true => (2.0 * (weight / GRAVITY).powi(2) / inertia, inertia * GRAVITY / (2.0 * weight)),
        false => (1.0, 0.0),
    };
    let extent = if weight > 0.0 { 0.5 * inertia } else { inertia };
    let sign = if around.gravity_torque < 0.0 { 1.0 } else { -1.0 };
    let armature = match parameters.compliance {
        Some(_) => 0.0,
        None => {
            let geometry = &parameters.geometry;
            let planets = geometry.planets as f64 * parameters.bodies.planet_equivalent_mass;
            (parameters.carrier_equivalent_mass() + planets) * geometry.carrier_base_radius().powi(2)
        }
    };
    let friction = &around.load_friction;
    TEMPLATE
        .replace("@JOINT@", &escaped_xml(&parameters.name))
        .replace("@PLUGIN@", plugin)
        // Two hyphens would end a comment.
        .replace("@FILE@", &escaped_xml(file).replace("--", "-&#45;"))
        .replace("@MASS@", &number(mass))
        .replace("@OFFSET@", &number(sign * arm))
        .replace("@INERTIA@", &number(extent))
        .replace("@ARMATURE@", &number(armature))
        .replace("@DAMPING@", &number(friction.viscous))
        .replace("@FRICTION@", &number(friction.coulomb))
        .replace("@LIMIT@", &number(around.torque_limit.min(1e6)))
}

/// Six significant digits suffice for every quantity of a joint file.
fn number(value: f64) -> String {
    let rounded: f64 = format!("{value:.6e}").parse().unwrap_or(value);
    format!("{rounded}")
}

const TEMPLATE: &str = r#"<!-- A joint on a stand, with its gears and their backlash. Load @FILE@ first:
     import mujoco; mujoco.mj_loadPluginLibrary("@FILE@"); model = mujoco.MjModel.from_xml_path(...)
     For a model of your own, copy extension, actuator and sensor; one instance for each joint. -->
<mujoco model="@JOINT@">
  <option timestep="0.001" integrator="implicitfast"/>
  <extension>
    <plugin plugin="@PLUGIN@">
      <instance name="joint">
        <!-- With observer and compensation in the loop, the control is the angle of the link [rad]: let ctrlrange be its range.
        <config key="controller" value="position"/> -->
      </instance>
    </plugin>
  </extension>
  <worldbody>
    <light pos="0 -1 2"/>
    <geom type="box" size="0.06 0.06 0.06" pos="0 0.07 0" rgba="0.3 0.35 0.4 1" contype="0" conaffinity="0"/>
    <body name="link">
      <!-- Friction and inertia of the link; the armature is the carrier of gears without compliance. -->
      <joint name="hinge" type="hinge" axis="0 1 0" damping="@DAMPING@" frictionloss="@FRICTION@" armature="@ARMATURE@"/>
      <inertial pos="0 0 @OFFSET@" mass="@MASS@" diaginertia="@INERTIA@ @INERTIA@ @INERTIA@"/>
      <geom type="capsule" fromto="0 0 0 0 0 -0.3" size="0.02" rgba="0.9 0.5 0.2 1" contype="0" conaffinity="0"/>
    </body>
  </worldbody>
  <actuator>
    <!-- The control is the torque at the motor's shaft [N m], without a controller. -->
    <plugin name="motor" joint="hinge" plugin="@PLUGIN@" instance="joint" ctrllimited="true" ctrlrange="-@LIMIT@ @LIMIT@"/>
  </actuator>
  <sensor>
    <!-- Angle [rad] and speed [rad/s] of the motor, of the link; gap [m]; contact (1 drive side, -1 back side, 0 gap);
         wind-up [m]; counts of motor and output encoder; torque in the air gap; torque of the gears on the link [N m].
         With a controller, then: commanded torque [N m]; estimated gap [m], 1 if valid; half-backlash [m], 1 if valid;
         contact, 1 if valid; angle [rad] and speed [rad/s] of the link; load torque [N m]; share of the compensation. -->
    <plugin name="joint" plugin="@PLUGIN@" instance="joint"/>
  </sensor>
</mujoco>
"#;

#[cfg(test)]
mod tests {
    use super::*;

    fn q1() -> JointFile {
        joint_file::read(joint_file::preset("q1").unwrap()).unwrap()
    }

    /// Text of an attribute of the model.
    fn attribute(model: &str, name: &str) -> String {
        let (_, rest) = model.split_once(&format!(" {name}=\"")).unwrap();
        rest.split('"').next().unwrap().to_owned()
    }

    #[test]
    fn link_has_inertia_and_weight_of_the_joint() {
        let (joint, model) = (q1(), model(&q1(), "lostmotion.q1", "q1.so"));
        let number = |name: &str| attribute(&model, name).split(' ').next_back().unwrap().parse::<f64>().unwrap();
        let (mass, extent) = (number("mass"), number("diaginertia"));
        let inertial = model.split_once("<inertial").unwrap().1;
        let arm: f64 = attribute(inertial, "pos").split(' ').next_back().unwrap().parse().unwrap();
        assert!((mass * arm * arm + extent - joint.parameters.link_inertia).abs() < 1e-6);
        assert!((mass * GRAVITY * -arm - joint.surroundings.gravity_torque).abs() < 1e-4);
    }

    #[test]
    fn odd_names_and_links_without_inertia_give_a_sound_model() {
        let mut joint = q1();
        joint.parameters.link_inertia = 0.0;
        let model = model(&joint, "lostmotion.q1", "a--b<c>.so");
        let comment = model.split_once("<!--").unwrap().1.split_once("-->").unwrap().0;
        assert!(!comment.contains("--") && !comment.contains('<'), "{comment}");
        assert!(!model.contains("inf") && !model.contains("NaN"), "{model}");
    }
}
