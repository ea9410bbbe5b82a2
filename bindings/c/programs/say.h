/* Prints lines to the standard output, on a host and through the emulator. */
#ifndef SAY_H
#define SAY_H

#include <stdint.h>

/* Prints a text. */
void say(const char *text);

/* Ends the program with a status; zero is success. Does not return. */
void end(int status);

/* Prints a number in sixteen hexadecimal digits. */
static inline void say_hexadecimal(uint64_t number) {
    char digits[17];
    int place;
    for (place = 15; place >= 0; place--) {
        digits[place] = "0123456789abcdef"[number & 15u];
        number >>= 4;
    }
    digits[16] = 0;
    say(digits);
}

/* Prints a number in decimal digits. */
static inline void say_decimal(uint64_t number) {
    char digits[21];
    int place = 20;
    digits[20] = 0;
    do {
        digits[--place] = (char)('0' + (int)(number % 10u));
        number /= 10u;
    } while (number != 0u);
    say(digits + place);
}

#endif
