//! Bounds on the errors that a certificate states, compared with the errors that `joint sim` measures on the same motions.

bounds! {
    /// Typical error stated over typical error measured, whichever is larger.
    TYPICAL: "typical error of a certificate against that of `sim` on the standard motion, the larger over the smaller, less one",
        below 1.0, was 0.76,
        scatters "The documented factor is 3. Both measure the board's step, the certificate against finer steps, `sim` against the reference; they may differ where a motion is cut off because it is unpredictable.";

    /// Median over the joints of [`TYPICAL`].
    TYPICAL_MEDIAN: "typical error of a certificate against that of `sim`, the larger over the smaller, less one, median over the joints",
        below 1.1e-3, was 7.6e-4,
        scatters "The error of the finer steps is a small part of the board step's error; other seeds have joints with shorter predictable motions.";

    /// Share of joints whose certified motion exceeds the stated bound.
    STANDARD_ABOVE_BOUND: "share of joints whose standard motion has an error above the bound",
        below 1e-9, was 0.0,
        argued "The bound is derived from motions that include this one.";

    /// Share of joints on which a motion outside the certificate exceeds the stated bound.
    OTHER_ABOVE_BOUND: "share of joints on which a motion outside the certificate has an error above the bound",
        below 0.2, was 0.1,
        argued "3 and 5 of two times fifty joints: other mesh phases and torques spread the error of rattling planets. Ten of fifty would be four deviations more.";
}
