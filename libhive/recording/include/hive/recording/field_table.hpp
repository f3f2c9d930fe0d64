// Fields of headers as CSV: one line per event, one column per named field.
#pragma once

#include <hive/event.hpp>

#include <set>
#include <string>
#include <vector>

namespace hive::recording {

class FieldTable {
public:
    /// @param fields  "event,zones.left.occupancy": after a dot stands a key, the `name` of an object in an array,
    /// or an index of an array, from 0
    /// @throws Error  invalid_argument: an empty field, or one given twice
    explicit FieldTable(const std::string& fields);

    /// "source,epoch,seq,time_us,sender,output" and the fields, with a line end.
    [[nodiscard]] std::string heading() const;
    /// Texts bare, other values as JSON, an unknown value empty.
    std::string row(const Event& event);
    /// Fields that no event had.
    [[nodiscard]] std::vector<std::string> missing() const;

private:
    std::vector<std::string> fields_;
    std::set<std::string> found_;
};

/// The fields of a header that hold one value each, as FieldTable takes them.
std::vector<std::string> single_fields(const Json& header);

}  // namespace hive::recording
