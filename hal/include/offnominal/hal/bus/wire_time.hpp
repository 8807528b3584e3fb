#pragma once

#include <offnominal/hal/bus/frame.hpp>

// How long frames keep a bus busy: for the load of a bus that is being planned.

namespace offnominal::hal {

struct BitRates {
  double nominal_bit_s = 1e6;
  double data_bit_s = 5e6;  // CAN FD, after the bit rate has switched
};

// Longest time that a frame takes, with as many stuff bits as its length allows and the gap to the
// next frame, s (ISO 11898-1:2015).
[[nodiscard]] constexpr double longest_wire_time_s(const Frame& frame, const BitRates& rates = {}) {
  const int data_bits = frame.remote ? 0 : 8 * frame.length;
  constexpr int kTail = 13;  // CRC delimiter, acknowledge and its delimiter, end of frame, gap
  if (!frame.fd) {
    // Start, identifier, control and CRC: what is stuffed beside the data.
    const int stuffed = (frame.extended ? 54 : 34) + data_bits;
    const int bits = stuffed + (stuffed - 1) / 4 + kTail;
    return bits / rates.nominal_bit_s;
  }
  // Up to the bit that switches the rate, then after the CRC.
  const int arbitration = frame.extended ? 36 : 17;
  const int nominal_bits = arbitration + (arbitration - 1) / 4 + kTail - 1;
  // Error state, length and data are stuffed as before; the CRC has a stuff bit at every fourth.
  const int dynamic = 5 + data_bits;
  const int crc = frame.length <= 16 ? 17 + 4 + 6 : 21 + 4 + 7;
  const int data_phase_bits = dynamic + dynamic / 4 + crc + 1;
  return nominal_bits / rates.nominal_bit_s + data_phase_bits / rates.data_bit_s;
}

}  // namespace offnominal::hal
