#pragma once

#include "components/laws/lanes.hpp"

namespace bris {

/// Correction for contacts that begin or end within a step. The force of a step acts from half a
/// step before to half a step after its instant; a contact that begins or ends in that interval
/// acts for a part of it only. The impulse given is that of this part, at the speed of the step.
/// The impulse of a contact of zero overlap is subtracted, so that the energy that the leapfrog
/// conserves in a contact (m v- v+ / 2 + U for a linear spring) equals that of the flight before
/// it.
///
/// The end of a contact is either predicted here from the speed of the last step, or corrected
/// afterwards (CorrectionOfEnd). A prediction may fail, because the force of the step changes the
/// speed: such a contact would end twice. Without dashpots the force at the end is so small that
/// this does not matter.
struct PartialStep {
    LaneMask begins; ///< the surfaces approached by more than the overlap in the last step
    LaneMask ends;   ///< the surfaces separate by more than the overlap in the next step

    PartialStep(const ContactLanes& c, double dt, bool predicts_end)
        : step_displacement_(c.closing * dt) {
        begins = step_displacement_ > c.overlap;
        ends = predicts_end ? -step_displacement_ > c.overlap : LaneMask{};
    }
    bool any() const { return bits(begins | ends) != 0; }

    /// Mean over a step of a force that grows as overlap^exponent from the first touch on, minus
    /// that of a contact of zero overlap.
    template <class Normal>
    Lane elastic(const ContactLanes& c, const CoefficientLanes& k, Lane whole) const {
        return (begins | ends) ? c.share * of_part<Normal>(c, k, part(c), step_displacement())
                               : whole;
    }
    /// Share of the dashpot's force that acts in the step.
    template <class Normal>
    Lane dashpot(const ContactLanes& c) const {
        return (begins | ends) ? Normal::share_of_dashpot(part(c)) : lanes(1);
    }

    /// Mean over a step of the elastic force of a contact that has lasted for the fraction `part`
    /// of a step at its instant, and half a step longer, at a constant speed (displacement in a
    /// step, m).
    template <class Normal>
    static Lane of_part(const ContactLanes& c, const CoefficientLanes& k, Lane part,
                        Lane displacement) {
        ContactLanes deeper = c, touch = c; // half a step later
        deeper.overlap = c.overlap + 0.5 * displacement;
        touch.overlap = 0.5 * displacement;
        return (Normal::stiffness(deeper, k).force * (part + 0.5) -
                Normal::stiffness(touch, k).force * 0.5) *
               (1 / (Normal::exponent + 1));
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

/// Correction for a contact that has ended in the last step: the surfaces are apart now, and
/// touched one step ago. The impulse of that step was given as if the contact went on for half a
/// step; what was missing or too much is given now. The time of separation is known from the
/// displacement of the last step, which the leapfrog makes at a constant speed. With it restitution
/// has an error of second order in dt for every phase between steps and contacts. Surfaces that are
/// further apart than the last step can explain were moved from outside, and are not corrected.
struct CorrectionOfEnd {
    /// Largest gap that is corrected, over the displacement of the surfaces in the last step. Above
    /// 1, because that displacement is computed to first order.
    static constexpr double largest_gap = 1.1;
    ContactLanes before; ///< the contact one step ago

    CorrectionOfEnd(const ContactLanes& c, double dt) : before(c) {
        separates_ = (c.closing < 0.0) & (c.overlap > (largest_gap * dt) * c.closing);
        displacement_ = separates_ ? -c.closing * dt : lanes(1);
        before.overlap = max(c.overlap + displacement_, lanes(0));
        part_ = min(before.overlap / displacement_, lanes(1));
    }
    /// Elastic force whose impulse over one step is that from half a step before the last instant
    /// to the separation.
    template <class Normal>
    Lane elastic(const CoefficientLanes& k) const {
        return before.share * PartialStep::of_part<Normal>(before, k, part_, displacement_);
    }
    /// Force to apply now. `given`: elastic force of the step before, N; `dashpot`: N s/m.
    template <class Normal>
    Lane force(Lane given, Lane elastic, Lane dashpot, double least_force) const {
        const Lane least = lanes(least_force), damping = dashpot * before.closing,
                   whole = given + damping,
                   due = max(elastic + Normal::share_of_dashpot(part_) * damping, least);
        return (separates_ & (whole > least)) ? due - whole : lanes(0);
    }

private:
    LaneMask separates_;
    Lane displacement_, part_;
};

} // namespace bris
