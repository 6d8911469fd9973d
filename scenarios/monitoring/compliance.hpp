#pragma once

#include "scenarios/monitoring/train_fit.hpp"
#include "scenarios/sensors/recording.hpp"

#include <string>

namespace bris {

/// How far a sensor rock gives way under a passing train.
struct RecordedCompliance {
    double value = 0;                    ///< m/N, displacement downwards over the load
    double deviation = 0;                ///< m/N, standard deviation of its error
    TrainFit fit = {};                   ///< of the recording to the train
    std::string impossible_because = {}; ///< empty: there is one
};

/// Fits the vertical acceleration of a recording (vibration_of, with the specific force turned back
/// by the angular rates) by the second derivative of the load of the train on a tie (passing_load)
/// at the speed at which it fits best (fit_train), both without frequencies below `lowest` (Hz),
/// which hold the errors of tilt and bias: an integrated acceleration would be dominated by its
/// noise at low frequencies, whereas the train is known. The load may begin up to half a second
/// before the recording, and must end in it but for half a second. Samples that are missing for at
/// most 0.05 s are interpolated. Impossible are recordings shorter than 95 % of the load or than 2
/// / lowest, with longer gaps, or with samples at the end of the range, those that are not of this
/// train (fit_train), and those in which it is not seen: less than three standard deviations. The
/// deviation includes 10 % of the compliance, since a rock does not follow the load in proportion.
RecordedCompliance compliance_of(const Recording& recording, const PassingTrain& passing,
                                 double lowest = 0.7);

} // namespace bris
