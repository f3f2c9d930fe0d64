// Which events are second answers, and refused.
#include "vectors.hpp"

#include <hive/event/answer_filter.hpp>
#include <hive/event_text.hpp>

namespace hive::wire {

TEST_CASE("answer vectors: of each work the first answer is taken, and others are refused")
{
    for (const auto& row : read_vectors("answers.jsonl", 23)) {
        CAPTURE(row.at("name"));
        event::AnswerFilter filter;
        Json taken = Json::array();
        for (const auto& header : row.at("events"))
            taken.push_back(filter.first(event_from_text(to_text(header), {})));
        CHECK_EQ(taken, row.at("taken"));
    }
}

}  // namespace hive::wire
