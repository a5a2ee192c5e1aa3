#include "logs.hpp"

#ifdef BUSBAR_KEY_LOG
#include <busbar/net/key_log_file.hpp>
#endif

namespace busbar::tool {

#ifdef BUSBAR_KEY_LOG

namespace {

/// Keeps the reason why a file is not used.
class LastLine final : public LogSink {
public:
    void write(LogLevel /*level*/, std::string_view /*source*/, std::string_view line) override
    {
        text = line;
    }

    std::string text;
};

} // namespace

std::unique_ptr<channel::KeyLog> open_key_log(Context& context, LogSink& log)
{
    const std::string& path = context.options.key_log;
    if (path.empty()) {
        return nullptr;
    }
    LastLine reason;
    if (const auto opened = net::KeyLogFile::open(path, reason); !opened) {
        throw Failure{Exit::Failed, reason.text,
                      "name a file that does not exist yet, or one that you alone can read"};
    }
    auto opened = net::KeyLogFile::open(path, log);
    if (!opened) {
        throw Failure{Exit::Failed, path + ": it cannot be written"};
    }
    context.warn("insecure", "the keys of all channels are written to " + path +
                                 "; with that file their traffic can be read");
    return *std::move(opened);
}

#else

std::unique_ptr<channel::KeyLog> open_key_log(Context& context, LogSink& /*log*/)
{
    if (!context.options.key_log.empty()) {
        throw Failure{Exit::Usage, "--key-log: this build does not export keys",
                      "build Busbar with the option BUSBAR_KEY_LOG, for a test bench"};
    }
    return nullptr;
}

#endif

} // namespace busbar::tool
