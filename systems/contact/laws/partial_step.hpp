#pragma once

#include "systems/contact/laws/law.hpp"

namespace bris {

/// Contacts that begin or end within a step. The force of a step acts from half a step before it to half a step after;
/// a contact that has come, or will go, in that time acts for a part of it only. Giving each step the impulse of that
/// part, with the speed of the step, makes energy and restitution wrong by third order in dt at each end, not by second
/// (springs) or first (dashpots). The leapfrog's own energy in a contact, m v- v+ / 2 + U for a linear spring, then is that
/// of the flight before: this takes the impulse of a quarter step off (what it would give to a mere touch).
struct PartialStep {
    LaneMask begins; ///< closed by more than its overlap in the last step
    LaneMask ends;   ///< opens by more than its overlap in the next
    Lane way;        ///< m, that the surfaces go in a step
    Lane part;       ///< of a step, from meeting to now or from now to parting, and half a step

    PartialStep(const ContactLanes& c, double dt) {
        way = c.closing * dt;
        begins = way > c.overlap;
        ends = -way > c.overlap;
        way = begins ? way : (ends ? -way : lanes(1));
        part = c.overlap / way + 0.5;
    }
    bool any() const { return bits(begins | ends) != 0; }

    /// Mean over a step of a force that grows as overlap^exponent, from meeting on, less that of a mere touch.
    template <class Normal> Lane elastic(const ContactLanes& c, const CoefficientLanes& k, Lane whole) const {
        ContactLanes deeper = c, touch = c; // half a step on
        deeper.overlap = c.overlap + 0.5 * way;
        touch.overlap = 0.5 * way;
        const Lane sum = Normal::stiffness(deeper, k).force * part - Normal::stiffness(touch, k).force * 0.5;
        return (begins | ends) ? c.share * sum * (1 / (Normal::exponent + 1)) : whole;
    }
    /// Share of a dashpot's force that counts.
    template <class Normal> Lane dashpot() const {
        return (begins | ends) ? 0.5 + Normal::damping_onset * (part - 0.5) : lanes(1);
    }
};

} // namespace bris
