#pragma once

#include <busbar/net/system.hpp>

namespace busbar::cli {

/// What the library reports, on standard error, if it is wanted; a Failure says what the user must
/// know.
class VerboseLog final : public LogSink {
public:
    explicit VerboseLog(bool is_verbose) : is_verbose_{is_verbose} {}

    void write(LogLevel level, std::string_view source, std::string_view text) override
    {
        if (is_verbose_) {
            log_.write(level, source, text);
        }
    }

private:
    bool is_verbose_;
    net::StderrLog log_{LogLevel::Debug};
};

} // namespace busbar::cli
