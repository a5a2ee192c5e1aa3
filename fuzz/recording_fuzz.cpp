#include <cstdint>
#include <cstdlib>
#include <string_view>

#include <busbar/harness/fault.hpp>
#include <busbar/harness/recorded_messages.hpp>
#include <busbar/harness/recording.hpp>

namespace recording_fuzz {

using namespace busbar;

namespace {

/// A fault is read again as it is described.
void read_faults(std::string_view text)
{
    const auto faults = harness::read_faults(text, "input");
    if (!faults) {
        return;
    }
    for (const harness::Fault& fault : *faults) {
        const std::string described = harness::describe(fault);
        const auto again = harness::parse_fault(described);
        if (!again || harness::describe(*again) != described) {
            std::abort();
        }
    }
}

} // namespace

/// What is read is written as a text that is read as the same, makes a capture, and does not differ
/// from itself. Other texts may be faults.
int test_one_input(const std::uint8_t* data, std::size_t size)
{
    const std::string_view text{reinterpret_cast<const char*>(data), size};
    const auto recording = harness::read_recording(text);
    if (!recording) {
        read_faults(text);
        return 0;
    }
    const auto again = harness::read_recording(harness::write_recording(*recording));
    if (!again || *again != *recording || harness::to_pcap(*recording).size() < 24) {
        std::abort();
    }
    const auto messages = harness::read_messages(*recording);
    if (!harness::compare_messages(messages, messages).empty() ||
        harness::write_messages(messages).empty()) {
        std::abort();
    }
    return 0;
}

} // namespace recording_fuzz
