//! SUNDIALS CVODE (6 or 7), Adams with fixed-point iteration, through a dozen functions of its C interface. With `restarted`, its root
//! finding stops at every kink of the forces and the integration restarts there.

use std::ffi::{c_int, c_long, c_void};
use std::ptr;

use super::Equations;

const ADAMS: c_int = 1;
const NORMAL: c_int = 1;
const ROOT_RETURN: c_int = 2;
const STEPS_MAX: c_long = 10_000_000;

type Opaque = *mut c_void;
type Rates = unsafe extern "C" fn(f64, Opaque, Opaque, Opaque) -> c_int;
type Roots = unsafe extern "C" fn(f64, Opaque, *mut f64, Opaque) -> c_int;

unsafe extern "C" {
    // The first argument is a null pointer up to version 6 and the number 0 from 7 on: the same register.
    fn SUNContext_Create(communicator: *mut c_void, context: *mut Opaque) -> c_int;
    fn SUNContext_Free(context: *mut Opaque) -> c_int;
    fn N_VMake_Serial(length: i64, data: *mut f64, context: Opaque) -> Opaque;
    fn N_VGetArrayPointer_Serial(vector: Opaque) -> *mut f64;
    fn N_VDestroy_Serial(vector: Opaque);
    fn SUNNonlinSol_FixedPoint(vector: Opaque, acceleration: c_int, context: Opaque) -> Opaque;
    fn SUNNonlinSolFree(solver: Opaque) -> c_int;
    fn CVodeCreate(method: c_int, context: Opaque) -> Opaque;
    fn CVodeInit(memory: Opaque, rates: Rates, time: f64, state: Opaque) -> c_int;
    fn CVodeReInit(memory: Opaque, time: f64, state: Opaque) -> c_int;
    fn CVodeSStolerances(memory: Opaque, relative: f64, absolute: f64) -> c_int;
    fn CVodeSetNonlinearSolver(memory: Opaque, solver: Opaque) -> c_int;
    fn CVodeSetUserData(memory: Opaque, data: *mut c_void) -> c_int;
    fn CVodeSetMaxNumSteps(memory: Opaque, steps: c_long) -> c_int;
    fn CVodeRootInit(memory: Opaque, count: c_int, roots: Roots) -> c_int;
    fn CVodeSetNoInactiveRootWarn(memory: Opaque) -> c_int;
    fn CVode(memory: Opaque, until: f64, state: Opaque, reached: *mut f64, task: c_int) -> c_int;
    fn CVodeFree(memory: *mut Opaque);
}

unsafe extern "C" fn rates<const N: usize, const D: usize>(time: f64, y: Opaque, dy: Opaque, data: Opaque) -> c_int {
    // SAFETY: CVODE passes the registered equations, and serial vectors of D entries.
    unsafe {
        let equations = &*data.cast::<Equations<N, D>>();
        let state = &*N_VGetArrayPointer_Serial(y).cast::<[f64; D]>();
        let rates = &mut *N_VGetArrayPointer_Serial(dy).cast::<[f64; D]>();
        equations.rates(time, state, rates);
    }
    0
}

unsafe extern "C" fn roots<const N: usize, const D: usize>(time: f64, y: Opaque, out: *mut f64, data: Opaque) -> c_int {
    // SAFETY: as above; `out` has room for the 4 N distances announced.
    unsafe {
        let equations = &*data.cast::<Equations<N, D>>();
        let state = &*N_VGetArrayPointer_Serial(y).cast::<[f64; D]>();
        equations.kinks(time, state, std::slice::from_raw_parts_mut(out, 4 * N));
    }
    0
}

/// Resources to be freed.
struct Session {
    context: Opaque,
    state: Opaque,
    solver: Opaque,
    memory: Opaque,
}

impl Drop for Session {
    fn drop(&mut self) {
        // SAFETY: each pointer came from its own create function, or is null, which all of these functions accept.
        unsafe {
            if !self.memory.is_null() {
                CVodeFree(&mut self.memory);
            }
            if !self.solver.is_null() {
                SUNNonlinSolFree(self.solver);
            }
            if !self.state.is_null() {
                N_VDestroy_Serial(self.state);
            }
            SUNContext_Free(&mut self.context);
        }
    }
}

pub(super) fn solve<const N: usize, const D: usize>(
    equations: &Equations<N, D>,
    times: &[f64],
    tolerance: f64,
    restarted: bool,
) -> Result<Vec<[f64; D]>, String> {
    let mut state = *equations.start();
    let check = |what: &str, status: c_int| if status < 0 { Err(format!("CVODE: {what}: {status}")) } else { Ok(()) };
    let null = ptr::null_mut();
    let mut session = Session { context: null, state: null, solver: null, memory: null };
    let mut states = Vec::with_capacity(times.len());
    // SAFETY: the calls follow CVODE's manual in order and number of arguments; `state` and `equations` outlive the session, which is
    // dropped first.
    unsafe {
        check("context", SUNContext_Create(null, &mut session.context))?;
        session.state = N_VMake_Serial(D as i64, state.as_mut_ptr(), session.context);
        session.memory = CVodeCreate(ADAMS, session.context);
        session.solver = SUNNonlinSol_FixedPoint(session.state, 0, session.context);
        if session.state.is_null() || session.memory.is_null() || session.solver.is_null() {
            return Err("CVODE: no memory".into());
        }
        check("start", CVodeInit(session.memory, rates::<N, D>, 0.0, session.state))?;
        check("data", CVodeSetUserData(session.memory, ptr::from_ref(equations).cast_mut().cast()))?;
        check("tolerances", CVodeSStolerances(session.memory, tolerance, tolerance))?;
        check("iteration", CVodeSetNonlinearSolver(session.memory, session.solver))?;
        check("steps", CVodeSetMaxNumSteps(session.memory, STEPS_MAX))?;
        if restarted {
            check("roots", CVodeRootInit(session.memory, 4 * N as c_int, roots::<N, D>))?;
            check("roots", CVodeSetNoInactiveRootWarn(session.memory))?;
        }
        for &time in times {
            let mut reached = 0.0;
            let mut on = time > 0.0;
            while on {
                let status = CVode(session.memory, time, session.state, &mut reached, NORMAL);
                check("step", status)?;
                on = status == ROOT_RETURN;
                if on {
                    check("restart", CVodeReInit(session.memory, reached, session.state))?;
                }
            }
            let mut entries = [0.0; D];
            entries.copy_from_slice(&*N_VGetArrayPointer_Serial(session.state).cast::<[f64; D]>());
            states.push(entries);
        }
    }
    Ok(states)
}
