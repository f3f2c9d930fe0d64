// The columns of the tables, which rows each has, and what each row is measured against.
#pragma once

#include "../harness/run.hpp"

#include <map>
#include <string>
#include <vector>

namespace hive::bench {

/// A row is "PROGRAM/VARIANT": "raw_shm/copy".
using Row = std::string;

struct Column {
    std::string name;  ///< "lat64"
    Test test;
    std::size_t size;
    int subscribers = 1;
    int window = 0;
    bool busy = false;
    bool dial = false;
    std::vector<Row> pairs;  ///< Hive and its limits, several times a round, neighbours in time
    std::vector<Row> once;   ///< peers and further limits, once a round
};

const std::vector<Column>& columns();
/// Every row, in the order in which tables list them.
const std::vector<Row>& rows();
/// The limit that a row of this column is measured against: what the machine allows over the same kind of transport.
Row limit_of(const Row& row, const std::string& column);

}  // namespace hive::bench
