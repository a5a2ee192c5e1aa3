#include "product_calls.hpp"

#include <atomic>
#include <span>
#include <string_view>
#include <thread>

#include "good_client.hpp"

namespace busbar::bench {

namespace {

using namespace std::chrono_literals;

/// What follows a command, such as a program that takes over, is the command's too.
constexpr std::chrono::milliseconds aftermath{500};
/// The server restarts up to ten seconds after it was asked to, and refuses other commands until
/// then.
constexpr std::chrono::milliseconds restart_time{12'000};

struct ProductCommand {
    std::string_view name;
    /// Words for `busbar`; empty: files are read again.
    std::string_view words;
    /// The server starts again some seconds after it.
    bool restarts{false};
};

constexpr std::array<ProductCommand, 17> machine_commands{{
    {"program check", "admin program check added.st"},
    {"program compare", "admin program compare first.st"},
    {"program edit, 3 more", "admin program edit added.st --yes"},
    {"program edit, 3 fewer", "admin program edit first.st --yes"},
    {"program download", "admin program download other.st --yes"},
    {"program restore", "admin program restore --yes"},
    {"file read again", {}},
    {"setting set", "admin setting set plc.scan_ms 10"},
    {"backup", "admin backup all.backup --yes"},
    {"verify", "admin verify all.backup"},
    {"mode run", "admin mode run --yes"},
    {"mode program", "admin mode program --yes"},
    {"log", "admin log -n 20"},
    {"status", "admin status"},
    {"restart", "admin shutdown --restart --seconds 0 --yes", true},
    {"restore, with its restart", "admin restore all.backup --yes", true},
    {"clear, with its restart", "admin clear --yes", true},
}};

constexpr std::array<ProductCommand, 9> model_commands{{
    {"project write, the first", "project write first.busbar --yes"},
    {"project update", "project update --yes"},
    {"project verify", "project verify first.busbar"},
    {"project write, the same", "project write first.busbar --yes"},
    {"project read", "project read read.busbar --yes"},
    {"project restart", "project restart --yes", true},
    {"project write, another", "project write second.busbar --yes"},
    {"project restart, another", "project restart --yes", true},
    {"labels read again", {}},
}};

Result<HostileRow> play(Load& load, OwnController& controller, const ToolUser& tool,
                        const ProductCommand& command)
{
    HostileRow row;
    row.attack = command.name;
    GoodClient client{load};
    if (const auto connected = client.connect(); !connected) {
        return fail(connected.error());
    }
    static_cast<void>(controller.take_longest_piece_ms());
    row.before = memory_of(controller.process());
    std::atomic<bool> is_done{false};
    std::thread administrator{[&] {
        bool is_well = true;
        if (command.words.empty()) {
            controller.reload();
        } else {
            is_well = tool.run("SecurityAdmin", command.words);
        }
        ++(is_well ? row.answered : row.refused);
        std::this_thread::sleep_for(aftermath + (command.restarts ? restart_time : 0ms));
        is_done = true;
    }};
    const auto read = client.read_while([&](double) { return !is_done; }, row);
    administrator.join();
    row.after = memory_of(controller.process());
    row.longest_piece_ms = controller.take_longest_piece_ms();
    row.status = read ? std::string{} : std::string{name(read.error())};
    return row;
}

} // namespace

Result<std::vector<HostileRow>> administer(Load& load, OwnController& controller,
                                           const ToolUser& tool, bool is_model)
{
    const bool has_files = is_model ? controller.write_project("first.busbar", "First") &&
                                          controller.write_project("second.busbar", "Second")
                                    : controller.write_program(0, "first.st") &&
                                          controller.write_program(3, "added.st") &&
                                          controller.write_program(11, "other.st");
    if (!has_files || !tool.prepare()) {
        return fail(status::Bad_ConfigurationError);
    }
    const std::span<const ProductCommand> commands =
        is_model ? std::span<const ProductCommand>{model_commands} : machine_commands;
    std::vector<HostileRow> rows;
    for (const ProductCommand& command : commands) {
        if (command.words.empty() && !controller.write_program(5)) {
            return fail(status::Bad_ResourceUnavailable);
        }
        auto row = play(load, controller, tool, command);
        if (!row) {
            return fail(row.error());
        }
        rows.push_back(*std::move(row));
    }
    return rows;
}

} // namespace busbar::bench
