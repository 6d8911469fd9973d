#pragma once

#include "scenarios/python/scene_builder.hpp"
#include "scenarios/python/steered_simulation.hpp"

#include <pybind11/pybind11.h>

// Every file that takes a scene or a simulation from Python includes this one.

namespace bris {

/// Takes an object from Python. An object whose __init__ has not been called, as Scene.__new__
/// makes one, would be memory without a value: throws pybind11::type_error.
template <class T>
struct InitialisedCaster : pybind11::detail::type_caster_base<T> {
    bool load(pybind11::handle from, bool convert) {
        namespace detail = pybind11::detail;
        if (from && pybind11::isinstance<T>(from)) {
            auto* object = reinterpret_cast<detail::instance*>(from.ptr());
            const auto* type = detail::get_type_info(typeid(T));
            if (object->get_value_and_holder(type).value_ptr() == nullptr)
                throw pybind11::type_error(std::string(Py_TYPE(from.ptr())->tp_name) +
                                           ": expected an object that was made by calling its "
                                           "class, found one whose __init__ was not called");
        }
        return detail::type_caster_base<T>::load(from, convert);
    }
};

} // namespace bris

namespace pybind11::detail {

template <>
class type_caster<bris::SceneBuilder> : public bris::InitialisedCaster<bris::SceneBuilder> {};
template <>
class type_caster<bris::SteeredSimulation>
    : public bris::InitialisedCaster<bris::SteeredSimulation> {};

} // namespace pybind11::detail
