//! Bounds on the errors that a certificate states, compared with the errors that `joint sim` measures on the same motions.

bounds! {
    /// Typical error stated over typical error measured, whichever is larger.
    TYPICAL: "typical error of a certificate beside that of `sim` on the standard motion, the greater over the smaller, less one",
        below 1.0, was 0.76,
        scatters "The promise is a factor of 3. Both measure the same step, one against finer steps, one against the reference; they may differ where a motion is cut off because nobody can predict it.";

    /// Median over the joints of [`TYPICAL`].
    TYPICAL_USUAL: "the same, median over the joints",
        below 1.1e-3, was 7.6e-4,
        scatters "Finer steps are right to a small part of the error of the board's; other seeds have joints of which less can be predicted.";

    /// Share of joints whose certified motion exceeds the stated bound.
    ABOVE_STANDARD: "share of joints whose standard motion has an error above the bound",
        below 1e-9, was 0.0,
        argued "None: the motion is one of those that the bound stands on.";

    /// Share of joints on which a motion outside the certificate exceeds the stated bound.
    ABOVE_OTHER: "share of joints of which a motion that the certificate does not know has an error above the bound",
        below 0.2, was 0.1,
        argued "Of two times fifty joints 3 and 5: other mesh phases and torques spread the error of rattling planets. Of fifty, ten would be four deviations more.";
}
