#pragma once

#include "components/laws/lanes.hpp"

namespace bris {

/// Contacts that begin or end within a step. The force of a step acts from half a step before it to
/// half a step after; a contact that has come, or will go, in that time acts for a part of it only.
/// Giving each step the impulse of that part, with the speed of the step, makes energy and
/// restitution wrong by third order in dt at each end, not by second (springs) or first (dashpots).
/// What a mere touch would get is taken off: then the energy that the leapfrog keeps in a contact
/// (m v- v+ / 2 + U for a linear spring) is that of the flight before.
struct PartialStep {
    LaneMask begins; ///< closed by more than its overlap in the last step
    LaneMask ends;   ///< opens by more than its overlap in the next

    PartialStep(const ContactLanes& c, double dt) : step_displacement_(c.closing * dt) {
        begins = step_displacement_ > c.overlap;
        ends = -step_displacement_ > c.overlap;
    }
    bool any() const { return bits(begins | ends) != 0; }

    /// Mean over a step of a force that grows as overlap^exponent, from meeting on, less that of a
    /// mere touch.
    template <class Normal>
    Lane elastic(const ContactLanes& c, const CoefficientLanes& k, Lane whole) const {
        ContactLanes deeper = c, touch = c; // half a step on
        deeper.overlap = c.overlap + 0.5 * step_displacement();
        touch.overlap = 0.5 * step_displacement();
        const Lane sum = Normal::stiffness(deeper, k).force * (part(c) + 0.5) -
                         Normal::stiffness(touch, k).force * 0.5;
        return (begins | ends) ? c.share * sum * (1 / (Normal::exponent + 1)) : whole;
    }
    /// Share of a dashpot's force that counts.
    template <class Normal>
    Lane dashpot(const ContactLanes& c) const {
        return (begins | ends) ? 0.5 + Normal::damping_onset * part(c) : lanes(1);
    }

private:
    Lane step_displacement() const {
        return begins ? step_displacement_ : (ends ? -step_displacement_ : lanes(1));
    } // m, that the surfaces go in a step
    Lane part(const ContactLanes& c) const {
        return c.overlap / step_displacement();
    } // of a step, from meeting to now or from now to parting
    Lane step_displacement_;
};

} // namespace bris
