//! Bounds of what the certificate says of errors, against what `joint sim` measures on the same motions.

bounds! {
    /// Typical error beside the measured one, either way.
    TYPICAL: "typical error of a certificate beside that of `sim` on the standard motion, the greater over the smaller, less one",
        below 1.0, was 0.76,
        scatters "The promise is a factor of 3. Both measure the same step, one against finer steps, one against the reference; they may differ where a motion is cut off because nobody can predict it.";

    /// The same, in the middle of all joints.
    TYPICAL_USUAL: "the same, median over the joints",
        below 1.1e-3, was 7.6e-4,
        scatters "Finer steps are right to a small part of the error of the board's; other seeds have joints of which less can be predicted.";

    /// Motions beyond the bound: the standard motion, and one that the certificate has not measured.
    ABOVE_STANDARD: "share of joints whose standard motion has an error above the bound",
        below 1e-9, was 0.0,
        argued "None: the motion is one of those that the bound stands on.";

    /// The same of the motion that the certificate does not know.
    ABOVE_OTHER: "share of joints of which a motion that the certificate does not know has an error above the bound",
        below 0.2, was 0.1,
        argued "Of two times fifty joints 3 and 5: other mesh phases and torques spread the error of rattling planets. Of fifty, ten would be four deviations more.";
}
