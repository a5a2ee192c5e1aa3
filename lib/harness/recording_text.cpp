#include <busbar/harness/recording.hpp>

#include <charconv>
#include <optional>

namespace busbar::harness {

namespace {

constexpr std::string_view format = "busbar-recording";
constexpr std::string_view version = "1";
constexpr std::string_view digits = "0123456789abcdef";

/// Removes the text before the next `end`, and that character, and returns the text.
std::string_view take_until(std::string_view& text, char end)
{
    const std::size_t size = text.find(end);
    const std::string_view part = text.substr(0, size);
    text.remove_prefix(size == std::string_view::npos ? text.size() : size + 1);
    return part;
}

template <typename Number>
std::optional<Number> number_of(std::string_view text)
{
    Number number{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    const bool is_all = error == std::errc{} && end == text.data() + text.size();
    return is_all && !text.empty() ? std::optional{number} : std::nullopt;
}

bool append_bytes(std::string_view hex, std::vector<std::byte>& bytes)
{
    if (hex.empty() || hex.size() % 2 != 0) {
        return false;
    }
    bytes.reserve(hex.size() / 2);
    for (std::size_t i = 0; i < hex.size(); i += 2) {
        const std::size_t high = digits.find(hex[i]);
        const std::size_t low = digits.find(hex[i + 1]);
        if (high == std::string_view::npos || low == std::string_view::npos) {
            return false;
        }
        bytes.push_back(static_cast<std::byte>(high * 16 + low));
    }
    return true;
}

/// Reads the lines of a recording one after the other and checks them against those before.
class RecordingReader {
public:
    RecordingReader(std::string_view text, const RecordingLimits& limits)
        : text_{text}, limits_{limits}
    {
    }

    Result<Recording> read()
    {
        std::string_view first = take_until(text_, '\n');
        if (take_until(first, ' ') != format) {
            return fail(status::Bad_DecodingError);
        }
        if (first != version) {
            return fail(status::Bad_NotSupported);
        }
        std::string_view second = take_until(text_, '\n');
        const bool is_seed = take_until(second, ' ') == "seed";
        const auto seed = number_of<std::uint64_t>(second);
        if (!is_seed || !seed) {
            return fail(status::Bad_DecodingError);
        }
        recording_.seed = *seed;
        while (!text_.empty()) {
            if (const StatusCode status = read_line(take_until(text_, '\n')); status.is_bad()) {
                return fail(status);
            }
        }
        return std::move(recording_);
    }

private:
    StatusCode read_line(std::string_view line)
    {
        const auto time = number_of<std::int64_t>(take_until(line, ' '));
        const auto connection = number_of<std::uint32_t>(take_until(line, ' '));
        const std::string_view verb = take_until(line, ' ');
        if (!time || !connection || *connection == 0 || *time < last_time_) {
            return status::Bad_DecodingError;
        }
        if (recording_.entries.size() >= limits_.max_entries ||
            *connection > limits_.max_connections || line.size() / 2 > limits_.max_bytes - size_) {
            return status::Bad_EncodingLimitsExceeded;
        }
        Recording::Entry entry;
        entry.time = Duration{*time};
        entry.connection = *connection;
        if (!read_verb(verb, line, entry)) {
            return status::Bad_DecodingError;
        }
        last_time_ = *time;
        size_ += entry.bytes.size();
        recording_.entries.push_back(std::move(entry));
        return {};
    }
    bool read_verb(std::string_view verb, std::string_view rest, Recording::Entry& entry)
    {
        if (verb == "open") {
            entry.kind = Recording::Kind::Opened;
            return rest.empty() && entry.connection == ++last_connection_;
        }
        if (entry.connection > last_connection_) {
            return false;
        }
        if (verb == "end") {
            entry.kind = Recording::Kind::Ended;
            entry.from = rest == "server" ? Side::Server : Side::Client;
            return rest == "server" || rest == "client";
        }
        entry.from = verb == "<" ? Side::Server : Side::Client;
        return (verb == "<" || verb == ">") && append_bytes(rest, entry.bytes);
    }

    std::string_view text_;
    RecordingLimits limits_;
    Recording recording_;
    std::int64_t last_time_{0};
    std::uint32_t last_connection_{0};
    std::size_t size_{0};
};

void append_entry(std::string& text, const Recording::Entry& entry)
{
    text += std::to_string(entry.time.count()) + " " + std::to_string(entry.connection);
    switch (entry.kind) {
    case Recording::Kind::Opened:
        text += " open";
        break;
    case Recording::Kind::Ended:
        text += entry.from == Side::Client ? " end client" : " end server";
        break;
    case Recording::Kind::Bytes:
        text += entry.from == Side::Client ? " > " : " < ";
        for (const std::byte byte : entry.bytes) {
            text += digits[std::to_integer<std::size_t>(byte >> 4U)];
            text += digits[std::to_integer<std::size_t>(byte & std::byte{15})];
        }
        break;
    }
    text += "\n";
}

} // namespace

std::string write_recording(const Recording& recording)
{
    std::string text{format};
    text.append(" ").append(version).append("\nseed ") += std::to_string(recording.seed) + "\n";
    for (const Recording::Entry& entry : recording.entries) {
        append_entry(text, entry);
    }
    return text;
}

Result<Recording> read_recording(std::string_view text, const RecordingLimits& limits)
{
    return RecordingReader{text, limits}.read();
}

} // namespace busbar::harness
