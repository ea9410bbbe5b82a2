/*
 * C++ interface over joint.h: objects that start in their own storage and can neither be copied nor moved, tables and
 * memories as spans. No allocation, no exception, no run-time type information. C++20.
 * MIT OR Apache-2.0.
 *
 *     lostmotion::Observer observer;
 *     lostmotion::Compensation compensation;
 *     lostmotion::Status status = observer.start(q1_tables);
 *     if (ok(status)) status = compensation.start(q1_tables);
 *     ...
 *     status = observer.step(samples);
 *     if (ok(status)) status = compensation.follow(observer, now, &ahead, torque);
 */
#ifndef LOSTMOTION_JOINT_HPP
#define LOSTMOTION_JOINT_HPP

#include <lostmotion/joint.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace lostmotion {

using Status = JointStatus;
using Samples = JointSamples;
using Estimates = JointEstimates;
using Motion = JointMotion;
using Impedance = JointImpedance;
using Torque = JointTorque;

/* Tables that `joint tables` wrote. They must not move or change while an object uses them. */
using Tables = std::span<const std::uint64_t>;
/* Memory of an observer, for the next power-up. */
using Memory = std::array<std::uint8_t, JOINT_MEMORY_BYTES>;

[[nodiscard]] constexpr bool ok(Status status) noexcept { return status == JOINT_STATUS_OK; }
[[nodiscard]] inline const char *name(Status status) noexcept { return joint_status_name(status); }
[[nodiscard]] inline const char *text(Status status) noexcept { return joint_status_text(status); }

/* Facts of tables: rate, period, ratio, limits. */
[[nodiscard]] inline Status facts(Tables tables, JointTablesFacts &facts) noexcept {
    return joint_tables_facts(tables.data(), tables.size_bytes(), &facts);
}

/* Storage of an object, which cannot be moved: the object depends on its address. */
template <typename Storage> class Object {
  public:
    Object() = default;
    Object(const Object &) = delete;
    Object(Object &&) = delete;
    Object &operator=(const Object &) = delete;
    Object &operator=(Object &&) = delete;
    ~Object() = default;

    /* Object for functions of joint.h. */
    [[nodiscard]] Storage *get() noexcept { return &storage; }
    [[nodiscard]] const Storage *get() const noexcept { return &storage; }

  private:
    Storage storage{};
};

class Observer : public Object<JointObserver> {
  public:
    /* Starts with maps of the encoders' errors. */
    [[nodiscard]] Status start(Tables tables) noexcept {
        return joint_observer_start(get(), sizeof(JointObserver), tables.data(), tables.size_bytes());
    }
    /* Starts without maps: for ideal encoders, or where flash is short. */
    [[nodiscard]] Status start_without_maps(Tables tables) noexcept {
        return joint_observer_start_without_maps(get(), sizeof(JointObserver), tables.data(), tables.size_bytes());
    }
    /* One control period. */
    [[nodiscard]] Status step(const Samples &samples) noexcept { return joint_observer_step(get(), &samples); }
    /* Estimates of the last period. */
    [[nodiscard]] Status estimates(Estimates &estimates) const noexcept {
        return joint_observer_estimates(get(), &estimates);
    }
    /* Outside of the control period. */
    [[nodiscard]] Status save(Memory &memory) const noexcept {
        return joint_observer_save(get(), memory.data(), memory.size());
    }
    /* Outside of the control period, before the first step. */
    [[nodiscard]] Status load(std::span<const std::uint8_t> memory) noexcept {
        return joint_observer_load(get(), memory.data(), memory.size());
    }
    /* The whole state, without addresses. */
    [[nodiscard]] Status save_state(std::array<std::uint32_t, JOINT_OBSERVER_STATE_WORDS> &state) const noexcept {
        return joint_observer_save_state(get(), state.data(), state.size());
    }
    [[nodiscard]] Status load_state(const std::array<std::uint32_t, JOINT_OBSERVER_STATE_WORDS> &state) noexcept {
        return joint_observer_load_state(get(), state.data(), state.size());
    }
};

class Compensation : public Object<JointCompensation> {
  public:
    [[nodiscard]] Status start(Tables tables) noexcept {
        return joint_compensation_start(get(), sizeof(JointCompensation), tables.data(), tables.size_bytes());
    }
    /* One control period of position control. `ahead` is the motion by facts.lead_s later, or nullptr if it is unknown. */
    [[nodiscard]] Status follow(const Observer &observer, const Motion &now, const Motion *ahead, Torque &torque) noexcept {
        return joint_compensation_follow(get(), observer.get(), &now, ahead, &torque);
    }
    /* One control period of impedance control. */
    [[nodiscard]] Status yield(const Observer &observer, const Impedance &impedance, Torque &torque) noexcept {
        return joint_compensation_yield(get(), observer.get(), &impedance, &torque);
    }
    /* The whole state, without addresses. */
    [[nodiscard]] Status save_state(std::array<std::uint32_t, JOINT_COMPENSATION_STATE_WORDS> &state) const noexcept {
        return joint_compensation_save_state(get(), state.data(), state.size());
    }
    [[nodiscard]] Status load_state(const std::array<std::uint32_t, JOINT_COMPENSATION_STATE_WORDS> &state) noexcept {
        return joint_compensation_load_state(get(), state.data(), state.size());
    }
};

class Probe : public Object<JointProbe> {
  public:
    /* The load must be held, and the motor at rest. */
    [[nodiscard]] Status start(Tables tables) noexcept {
        return joint_probe_start(get(), sizeof(JointProbe), tables.data(), tables.size_bytes());
    }
    /* One control period, instead of the compensation's. */
    [[nodiscard]] Status step(const Observer &observer, JointProbed &probed) noexcept {
        return joint_probe_step(get(), observer.get(), &probed);
    }
};

class Wiring : public Object<JointWiring> {
  public:
    /* The joint must be at rest, and free to turn by a few degrees at the output. */
    [[nodiscard]] Status start(Tables tables) noexcept {
        return joint_wiring_start(get(), sizeof(JointWiring), tables.data(), tables.size_bytes());
    }
    /* One control period, instead of the observer's and the compensation's. */
    [[nodiscard]] Status step(const Samples &samples, float allowed_torque_Nm, JointWiringStep &step) noexcept {
        return joint_wiring_step(get(), &samples, allowed_torque_Nm, &step);
    }
    /* Outside of the control period. */
    [[nodiscard]] Status verdicts(JointWiringVerdicts &verdicts) const noexcept {
        return joint_wiring_verdicts(get(), &verdicts);
    }
};

class Plant : public Object<JointPlant> {
  public:
    [[nodiscard]] Status start(Tables tables) noexcept {
        return joint_plant_start(get(), sizeof(JointPlant), tables.data(), tables.size_bytes());
    }
    [[nodiscard]] Status step(float motor_torque_Nm, float load_torque_Nm) noexcept {
        return joint_plant_step(get(), motor_torque_Nm, load_torque_Nm);
    }
    /* With a link that another simulator moves; `link_torque_Nm` receives the mean torque of the gears on it. */
    [[nodiscard]] Status step_with_link(float motor_torque_Nm, float link_inverse_inertia_per_kg_m2,
                                        float link_acceleration_rad_per_s2, float &link_torque_Nm) noexcept {
        return joint_plant_step_with_link(get(), motor_torque_Nm, link_inverse_inertia_per_kg_m2,
                                          link_acceleration_rad_per_s2, &link_torque_Nm);
    }
    [[nodiscard]] Status shift(std::int32_t turns, float fraction_turns, float speed_rad_per_s) noexcept {
        return joint_plant_shift(get(), turns, fraction_turns, speed_rad_per_s);
    }
    [[nodiscard]] Status save(std::array<std::uint32_t, JOINT_PLANT_STATE_WORDS> &state) const noexcept {
        return joint_plant_save(get(), state.data(), state.size());
    }
    [[nodiscard]] Status load(const std::array<std::uint32_t, JOINT_PLANT_STATE_WORDS> &state) noexcept {
        return joint_plant_load(get(), state.data(), state.size());
    }
    [[nodiscard]] Status speeds(float &motor_rad_per_s, float &link_rad_per_s) const noexcept {
        return joint_plant_speeds(get(), &motor_rad_per_s, &link_rad_per_s);
    }
    [[nodiscard]] Status samples(Samples &samples) const noexcept { return joint_plant_samples(get(), &samples); }
    [[nodiscard]] Status outputs(JointPlantOutputs &outputs) const noexcept { return joint_plant_outputs(get(), &outputs); }
    [[nodiscard]] Status digest(std::uint64_t &digest) const noexcept { return joint_plant_digest(get(), &digest); }
};

} // namespace lostmotion

#endif
