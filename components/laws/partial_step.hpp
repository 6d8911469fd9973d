#pragma once

#include "components/laws/lanes.hpp"

namespace bris {

/// Correction for contacts that begin or end within a step. The force of a step acts from half a
/// step before to half a step after its instant; a contact that begins or ends in that interval
/// acts for a part of it only. The impulse given is that of this part, at the speed of the step.
/// The error of energy and restitution is then of third order in dt at each end, instead of second
/// (springs) or first (dashpots). The impulse of a contact of zero overlap is subtracted, so that
/// the energy that the leapfrog conserves in a contact (m v- v+ / 2 + U for a linear spring) equals
/// that of the flight before it.
struct PartialStep {
    LaneMask begins; ///< the surfaces approached by more than the overlap in the last step
    LaneMask ends;   ///< the surfaces separate by more than the overlap in the next step

    PartialStep(const ContactLanes& c, double dt) : step_displacement_(c.closing * dt) {
        begins = step_displacement_ > c.overlap;
        ends = -step_displacement_ > c.overlap;
    }
    bool any() const { return bits(begins | ends) != 0; }

    /// Mean over a step of a force that grows as overlap^exponent from the first touch on, minus
    /// that of a contact of zero overlap.
    template <class Normal>
    Lane elastic(const ContactLanes& c, const CoefficientLanes& k, Lane whole) const {
        ContactLanes deeper = c, touch = c; // half a step later
        deeper.overlap = c.overlap + 0.5 * step_displacement();
        touch.overlap = 0.5 * step_displacement();
        const Lane sum = Normal::stiffness(deeper, k).force * (part(c) + 0.5) -
                         Normal::stiffness(touch, k).force * 0.5;
        return (begins | ends) ? c.share * sum * (1 / (Normal::exponent + 1)) : whole;
    }
    /// Share of the dashpot's force that acts in the step.
    template <class Normal>
    Lane dashpot(const ContactLanes& c) const {
        return (begins | ends) ? 0.5 + Normal::damping_onset * part(c) : lanes(1);
    }

private:
    /// Distance (m) that the surfaces move in a step.
    Lane step_displacement() const {
        return begins ? step_displacement_ : (ends ? -step_displacement_ : lanes(1));
    }
    /// Fraction of a step between the first touch and now, or between now and the separation.
    Lane part(const ContactLanes& c) const { return c.overlap / step_displacement(); }
    Lane step_displacement_;
};

} // namespace bris
