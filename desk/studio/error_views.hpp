#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "compare/error_variable.hpp"
#include "studio/charts.hpp"
#include "studio/workbench.hpp"

namespace offnominal::desk::studio {

/// What the reader chooses to see a joint's error over: of the recording and of the part of the
/// time that is shown. As report pages hold them; they throw as check().

/// A map of its mean over two variables, of this joint or of another.
nlohmann::json map_of(const Workbench& bench, const Compared& now, const View& view,
                      const ErrorOver& x, const ErrorOver& y);

/// The sines that it is made of, as read and now.
enum class SpectrumOver { kFrequency, kOrder };
nlohmann::json spectrum_of(const Workbench& bench, const Compared& now, const View& view,
                           SpectrumOver over);

/// What the error looks like without an effect, over the variable that the effect's torque follows
/// most, and that torque laid over it: of the fitted recordings, on the joint whose error it
/// changes most. `without` is the model `with` it, less the effect.
nlohmann::json evidence_of(const Compared& without, const Compared& with,
                           const RobotEffect& effect);

}  // namespace offnominal::desk::studio
