// The plant as the device under a unit test: the controller is tried without a board and without a motor.
#define DOCTEST_CONFIG_IMPLEMENT_WITH_MAIN
#include <doctest/doctest.h>

#include <cmath>
#include <cstdint>

#include "controller.h"
#include "tables_of_test.h"

namespace {

// Count of the output encoder where the plant's link is at zero.
constexpr std::uint32_t output_zero = 39322;

// The link's angle after so many periods at a place.
double link_turns_after(Mode mode, unsigned periods, float place_turns) {
    static Controller controller;
    static JointPlant plant;
    REQUIRE(controller_start(&controller, tables_of_test, sizeof tables_of_test) == JOINT_STATUS_OK);
    REQUIRE(joint_plant_start(&plant, sizeof plant, tables_of_test, sizeof tables_of_test) == JOINT_STATUS_OK);
    controller.mode = mode;
    JointMotion there{};
    for (unsigned period = 0; period < periods; period++) {
        // Half a second on the way, softly.
        const float s = std::fmin(1.0f, static_cast<float>(period) * controller.facts.period_s * 2.0f);
        there.fraction_turns = output_zero / 131072.0f + place_turns * s * s * (3.0f - 2.0f * s);
        JointSamples samples;
        REQUIRE(joint_plant_samples(&plant, &samples) == JOINT_STATUS_OK);
        // Encoders as they are mounted: raw counts of 14 and 17 bits, each with a zero of its own.
        samples.motor.counts = (samples.motor.counts + 4660u) % 16384u;
        samples.output.counts = (samples.output.counts + output_zero) % 131072u;
        REQUIRE(controller_period(&controller, &samples, &there, nullptr) == JOINT_STATUS_OK);
        REQUIRE(joint_plant_step(&plant, TORQUE_CONSTANT_NM_PER_A * controller.reference_A, 0.0f) == JOINT_STATUS_OK);
    }
    JointPlantOutputs outputs;
    REQUIRE(joint_plant_outputs(&plant, &outputs) == JOINT_STATUS_OK);
    return outputs.carrier_turns + outputs.carrier_fraction / 4294967296.0;
}

} // namespace

TEST_CASE("the link arrives to a milliradian, though the gap is of 3.8") {
    CHECK(std::fabs(link_turns_after(MODE_POSITION, 20000, 0.05f) - 0.05) < 0.001 / 6.28);
}

TEST_CASE("a spring gives way to nothing when nobody pulls") {
    CHECK(std::fabs(link_turns_after(MODE_IMPEDANCE, 20000, 0.02f) - 0.02) < 0.02 / 6.28);
}

TEST_CASE("what is wrong is told") {
    JointObserver observer{};
    JointSamples samples{};
    CHECK(joint_observer_step(&observer, &samples) == JOINT_STATUS_NOT_STARTED);
    CHECK(joint_observer_step(nullptr, &samples) == JOINT_STATUS_NULL_POINTER);
}
