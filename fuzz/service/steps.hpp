#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

/// The form of the service target's inputs: steps, each an action, a length (UInt16, little-endian)
/// and so many bytes. Whatever the fuzzer makes of an input can be read; what is cut off ends it.
namespace busbar::fuzz {

struct Step {
    enum class Kind : std::uint8_t { Request, RawRequest, Time, Backend };
    static constexpr std::uint8_t other_session = 0x10;

    /// Kind in the low bits, and other_session.
    std::uint8_t action{0};
    /// Of a request: the id of its binary encoding (UInt16), and its body, which a RawRequest is
    /// sent with as it is. Of others: what the world does with it.
    std::vector<std::uint8_t> payload;

    [[nodiscard]] Kind kind() const
    {
        const unsigned number = action % 8U;
        return number < 5 ? Kind::Request : static_cast<Kind>(number - 4);
    }
    [[nodiscard]] bool is_of_other_session() const { return (action & other_session) != 0; }
};

inline constexpr std::size_t max_steps = 24;

[[nodiscard]] inline std::vector<Step> read_steps(std::span<const std::uint8_t> input)
{
    std::vector<Step> steps;
    while (input.size() >= 3 && steps.size() < max_steps) {
        const std::size_t wanted = input[1] + std::size_t{input[2]} * 256;
        const std::size_t size = wanted < input.size() - 3 ? wanted : input.size() - 3;
        const auto payload = input.subspan(3, size);
        steps.push_back({input[0], {payload.begin(), payload.end()}});
        input = input.subspan(3 + size);
    }
    return steps;
}

/// As many as fit into `room` bytes.
[[nodiscard]] inline std::vector<std::uint8_t> written(std::span<const Step> steps,
                                                       std::size_t room)
{
    std::vector<std::uint8_t> bytes;
    for (const Step& step : steps) {
        if (step.payload.size() > UINT16_MAX || bytes.size() + 3 + step.payload.size() > room) {
            break;
        }
        bytes.push_back(step.action);
        bytes.push_back(static_cast<std::uint8_t>(step.payload.size() % 256));
        bytes.push_back(static_cast<std::uint8_t>(step.payload.size() / 256));
        bytes.insert(bytes.end(), step.payload.begin(), step.payload.end());
    }
    return bytes;
}

} // namespace busbar::fuzz
