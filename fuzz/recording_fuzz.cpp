#include <cstdint>
#include <cstdlib>
#include <string_view>

#include <busbar/harness/recording.hpp>

namespace recording_fuzz {

using namespace busbar;

/// What is read is written as a text that is read as the same, and makes a capture.
int test_one_input(const std::uint8_t* data, std::size_t size)
{
    const std::string_view text{reinterpret_cast<const char*>(data), size};
    const auto recording = harness::read_recording(text);
    if (!recording) {
        return 0;
    }
    const auto again = harness::read_recording(harness::write_recording(*recording));
    if (!again || *again != *recording || harness::to_pcap(*recording).size() < 24) {
        std::abort();
    }
    return 0;
}

} // namespace recording_fuzz
