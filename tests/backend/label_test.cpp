#include <busbar/backend/label.hpp>

#include <catch2/catch.hpp>

namespace label_test {

using namespace busbar::backend;

TEST_CASE("the memory that a label takes follows from its type")
{
    struct Row {
        LabelKind kind;
        std::size_t bytes;
        std::size_t words;
    };
    const auto row = GENERATE(values<Row>({
        {{LabelType::Bit}, 1, 1},
        {{LabelType::UnsignedWord}, 2, 1},
        {{LabelType::DoubleWord}, 4, 2},
        {{LabelType::Float}, 4, 2},
        {{LabelType::Double}, 8, 4},
        {{LabelType::Time}, 4, 2},
        {{LabelType::String, TimerPart::None, 9}, 10, 5},
        {{LabelType::String, TimerPart::None, 10}, 11, 6},
        {{LabelType::UnicodeString, TimerPart::None, 10}, 22, 11},
        {{LabelType::Timer, TimerPart::Contact}, 1, 1},
        {{LabelType::Counter, TimerPart::Current}, 2, 1},
        {{LabelType::LongTimer, TimerPart::Coil}, 1, 1},
        {{LabelType::LongRetentiveTimer, TimerPart::Current}, 4, 2},
        // Without a part, a timer is no value.
        {{LabelType::Timer}, 0, 0},
        {{LabelType::Pointer}, 0, 0},
        {{LabelType::Structure}, 0, 0},
    }));
    CHECK(size_of(row.kind) == row.bytes);
    CHECK(words_of(row.kind) == row.words);
}

} // namespace label_test
