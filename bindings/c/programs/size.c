/* Links the part of the library that a kind of firmware uses, to measure its size: chosen by one of the names below. */
#include "say.h"

#include <lostmotion/joint.h>
#include "tables_of_test.h"

static JointSamples samples;

#if defined(OBSERVER) || defined(OBSERVER_WITHOUT_MAPS) || defined(CONTROL) || defined(CONTROL_WITHOUT_MAPS)
static JointObserver observer;
static JointEstimates estimates;
#endif
#if defined(CONTROL) || defined(CONTROL_WITHOUT_MAPS)
static JointCompensation compensation;
static JointMotion now, ahead;
static JointImpedance spring;
static JointTorque torque;
#endif
#ifdef PLANT
static JointPlant plant;
#endif

int main(void) {
    JointStatus status = JOINT_STATUS_OK;
    (void)samples;
#if defined(OBSERVER) || defined(CONTROL)
    status |= joint_observer_start(&observer, sizeof observer, tables_of_test, sizeof tables_of_test);
#elif defined(OBSERVER_WITHOUT_MAPS) || defined(CONTROL_WITHOUT_MAPS)
    status |= joint_observer_start_without_maps(&observer, sizeof observer, tables_of_test, sizeof tables_of_test);
#endif
#if defined(OBSERVER) || defined(OBSERVER_WITHOUT_MAPS) || defined(CONTROL) || defined(CONTROL_WITHOUT_MAPS)
    status |= joint_observer_step(&observer, &samples);
    status |= joint_observer_estimates(&observer, &estimates);
#endif
#if defined(CONTROL) || defined(CONTROL_WITHOUT_MAPS)
    status |= joint_compensation_start(&compensation, sizeof compensation, tables_of_test, sizeof tables_of_test);
    status |= joint_compensation_follow(&compensation, &observer, &now, &ahead, &torque);
    status |= joint_compensation_yield(&compensation, &observer, &spring, &torque);
#endif
#ifdef PLANT
    status |= joint_plant_start(&plant, sizeof plant, tables_of_test, sizeof tables_of_test);
    status |= joint_plant_step(&plant, 0.0f, 0.0f);
    status |= joint_plant_samples(&plant, &samples);
#endif
    return status == JOINT_STATUS_OK ? 0 : 1;
}
