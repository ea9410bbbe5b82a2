/*
 * The closed loop of run.h through the C++ interface: the same digest. Link it with say() of host.c.
 */
#include <lostmotion/joint.hpp>

#include <type_traits>

#include "run.h"
#include "say.h"
#include "tables_of_test.h"

#ifndef PERIODS
#define PERIODS 20000u
#endif

static_assert(!std::is_copy_constructible_v<lostmotion::Observer> && !std::is_move_constructible_v<lostmotion::Observer>);

using lostmotion::ok;

namespace {

lostmotion::Observer observer;
lostmotion::Compensation compensation;
lostmotion::Plant plant;
Run run;

lostmotion::Status start(lostmotion::Tables tables) {
    JointTablesFacts facts{};
    lostmotion::Status status = lostmotion::facts(tables, facts);
    run.digest = 0x6a6f696e742d3031ull;
    run.scale = facts.control_rate_Hz / 10000u;
    run.lead = static_cast<uint32_t>(facts.lead_s * static_cast<float>(facts.control_rate_Hz));
    if (ok(status)) status = plant.start(tables);
    if (ok(status)) status = observer.start(tables);
    if (ok(status)) status = compensation.start(tables);
    return status;
}

lostmotion::Status period() {
    const uint32_t scale = run.scale, at = run.period;
    const lostmotion::Motion now = run_motion(&run, at), ahead = run_motion(&run, at + run.lead);
    lostmotion::Samples samples{};
    lostmotion::Status status = plant.samples(samples);
    if (at >= 15000u * scale && at < 16000u * scale) {
        samples.has_output = 0;
    }
    if (ok(status)) status = observer.step(samples);
    if (at / (10000u * scale) % 2u) {
        const lostmotion::Impedance spring{now.turns, now.fraction_turns, now.speed_rad_per_s, 0.0f, 100.0f, 3.0f};
        if (ok(status)) status = compensation.yield(observer, spring, run.torque);
    } else if (ok(status)) {
        status = compensation.follow(observer, now, &ahead, run.torque);
    }
    if (ok(status)) status = plant.step(run.torque.motor_torque_Nm, at / (1700u * scale) % 2u ? -1.0f : 1.0f);
    if (ok(status)) status = observer.estimates(run.estimates);
    uint64_t digest = 0;
    if (ok(status)) status = plant.digest(digest);
    run_note(&run, digest);
    return status;
}

} // namespace

int main() {
    lostmotion::Status status = start(tables_of_test);
    while (ok(status) && run.period < PERIODS) {
        status = period();
    }
    lostmotion::Memory memory{};
    lostmotion::Observer other;
    if (ok(status)) status = observer.save(memory);
    if (ok(status)) status = other.start(tables_of_test);
    if (ok(status)) status = other.load(memory);
    if (!ok(status)) {
        say(lostmotion::text(status));
        return 1;
    }
    say("digest ");
    say_hexadecimal(run.digest);
    say("\n");
    return 0;
}
