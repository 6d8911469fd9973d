#pragma once

#include "engine/archive.hpp"
#include "engine/column.hpp"

#include <pybind11/numpy.h>
#include <vector>

namespace bris {

/// NumPy type of the numbers of an array. Integers are unsigned. Throws InputError for a size that
/// no NumPy type has.
pybind11::dtype dtype_of(Scalar scalar, std::size_t scalar_size);

/// Shape of an array: (rows), or (rows, columns) if there is not just one column.
std::vector<pybind11::ssize_t> shape_of(std::size_t rows, std::size_t columns);

/// Copies of all arrays of an archive by their paths, as "bodies/position"; rows are in the order
/// of the ids. An array with one column has one dimension, any other has the shape (rows, columns).
pybind11::dict arrays_of(const Archive& archive);

/// An array that shows the memory of a State column itself, by row. `owner` lives at least as long
/// as the array.
pybind11::array view_of(Column& column, const pybind11::object& owner, bool writable);

} // namespace bris
