// A simulated PLC that Modbus TCP or SLMP clients can read and write, for tests without a PLC.
// usage: busbar-plc-responder modbus|slmp [OPTIONS]; commands on standard input change it.
#include <algorithm>
#include <charconv>
#include <cstdio>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>
#include <asio/io_context.hpp>
#include <asio/posix/stream_descriptor.hpp>
#include <asio/read_until.hpp>
#include <asio/signal_set.hpp>
#include <asio/streambuf.hpp>
#include <unistd.h>

#include "command_line/program_options.hpp"
#include "sockets.hpp"

using namespace plc_responder;

namespace {

constexpr const char* commands_help =
    "Commands on standard input, each answered by a line:\n"
    "  set ADDRESS VALUE | get ADDRESS | count ADDRESS\n"
    "  refuse ADDRESS [CODE] | allow   refuse it, with an exception or end code | nothing more\n"
    "  label NAME TYPE HEX             adds an SLMP label: its type id, and its bytes\n"
    "  slow MS | stop | run            time of an answer | STOP | RUN\n"
    "  close                           ends all connections";

/// Reads a number of 16 bits: "17", "-3", "0x1F".
std::optional<std::uint16_t> number_of(std::string_view text)
{
    constexpr int hexadecimal = 16;
    const bool is_hexadecimal = text.starts_with("0x");
    const std::string_view digits = text.substr(is_hexadecimal ? 2 : 0);
    std::int32_t value = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value,
                                              is_hexadecimal ? hexadecimal : 10);
    const bool is_number = error == std::errc{} && end == digits.data() + digits.size();
    return is_number && value >= INT16_MIN && value <= UINT16_MAX
               ? std::optional{static_cast<std::uint16_t>(value)}
               : std::nullopt;
}

std::optional<std::vector<std::byte>> bytes_of(std::string_view hexadecimal)
{
    std::vector<std::byte> bytes;
    for (; hexadecimal.size() >= 2; hexadecimal.remove_prefix(2)) {
        const auto byte = number_of("0x" + std::string{hexadecimal.substr(0, 2)});
        if (!byte) {
            return std::nullopt;
        }
        bytes.push_back(static_cast<std::byte>(*byte));
    }
    return hexadecimal.empty() ? std::optional{bytes} : std::nullopt;
}

struct Options {
    bool is_slmp{false};
    bool is_udp{false};
    bool is_3e_only{false};
    Family family{Family::IqR};
    std::string password{};
    std::string host{"127.0.0.1"};
    std::uint16_t port{0};
    std::size_t max_connections{64};
    std::vector<std::uint8_t> units{};
    /// Options that are commands: those of one name in their order.
    std::vector<std::string> commands{};
};

/// An option whose value cannot be used, which only the PLC knows.
class UsageError : public std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// "LABEL=1:01" becomes the command "label LABEL 1 01", but holding:0 has a colon of its own.
std::string command_of(const char* name, std::string value)
{
    const std::size_t equals = value.find('=');
    if (equals != std::string::npos) {
        std::replace(value.begin() + static_cast<std::ptrdiff_t>(equals), value.end(), ':', ' ');
        value[equals] = ' ';
    }
    return name + (' ' + value);
}

/// Adds an option that can be repeated and is carried out as the command of its name.
void add_command(CLI::App& app, Options& options, const char* name, const char* form,
                 const std::string& help)
{
    app.add_option_function<std::vector<std::string>>(
           std::string{"--"} + name,
           [&options, name](const std::vector<std::string>& values) {
               for (const std::string& value : values) {
                   options.commands.push_back(command_of(name, value));
               }
           },
           help)
        ->type_name(form)
        ->allow_extra_args(false);
}

/// Takes "127.0.0.1:5020" or "[::1]:5020" apart.
void take_listener(Options& options, const std::string& text)
{
    const std::size_t colon = std::min(text.rfind(':'), text.size());
    const std::string port = text.substr(std::min(colon + 1, text.size()));
    const auto number = number_of(port);
    if (colon == text.size() || !number || port.starts_with('-')) {
        throw CLI::ValidationError{"--listen", "found " + text + ", expected HOST:PORT"};
    }
    const bool has_brackets = text.starts_with('[') && colon > 1;
    options.host = has_brackets ? text.substr(1, colon - 2) : text.substr(0, colon);
    options.port = *number;
}

void add_options(CLI::App& app, Options& options)
{
    app.add_option_function<std::string>(
           "protocol", [&](const std::string& name) { options.is_slmp = name == "slmp"; },
           "what the PLC speaks: modbus or slmp")
        ->required()
        ->type_name("PROTOCOL")
        ->check(CLI::IsMember({"modbus", "slmp"}));
    app.add_option_function<std::string>(
           "--listen", [&](const std::string& text) { take_listener(options, text); },
           "where it serves, 127.0.0.1:0 by itself: a free port, which is printed")
        ->type_name("HOST:PORT");
    app.add_flag("--udp", options.is_udp, "SLMP over UDP instead of TCP");
    app.add_option_function<std::string>(
           "--plc",
           [&](const std::string& name) {
               options.family = name == "q" ? Family::Q : name == "fx5" ? Family::Fx5 : Family::IqR;
           },
           "family of the PLC with SLMP, iqr by itself; q is a built-in port")
        ->type_name("FAMILY")
        ->check(CLI::IsMember({"iqr", "q", "fx5"}));
    app.add_option("--password", options.password,
                   "remote password that opens the port of a PLC with SLMP")
        ->type_name("TEXT");
    app.add_option_function<std::string>(
           "--frame", [&](const std::string& name) { options.is_3e_only = name == "3e"; },
           "3e: 4E frames of SLMP have no answer; 4e, by itself: both have")
        ->type_name("FRAME")
        ->check(CLI::IsMember({"3e", "4e"}));
    app.add_option("--units", options.units,
                   "units that a Modbus gateway serves, 1,2; without it every unit is this PLC")
        ->type_name("UNIT")
        ->delimiter(',')
        ->allow_extra_args(false)
        ->check(CLI::Range(0, UINT8_MAX));
    app.add_option("--connections", options.max_connections, "more are closed at once")
        ->type_name("COUNT")
        ->check(CLI::Range(0, UINT16_MAX))
        ->capture_default_str();
    add_command(app, options, "set", "ADDRESS=VALUE", "as the command set; can be repeated");
    add_command(app, options, "count", "ADDRESS",
                "counts up ten times a second while the PLC is in RUN; can be repeated");
    add_command(app, options, "refuse", "ADDRESS", "as the command refuse; can be repeated");
    add_command(app, options, "label", "NAME=TYPE:HEX", "as the command label; can be repeated");
    app.add_option_function<std::string>(
           "--delay", [&](const std::string& ms) { options.commands.push_back("slow " + ms); },
           "as the command slow")
        ->type_name("MS");
    app.add_flag_callback(
        "--stop", [&] { options.commands.emplace_back("stop"); }, "the PLC is in STOP");
    app.footer(commands_help);
    app.final_callback([&] {
        if (options.is_udp && !options.is_slmp) {
            throw CLI::ValidationError{"--udp", "is for slmp"};
        }
    });
}

/// Serves the PLC, and executes commands.
class Program {
public:
    explicit Program(const Options& options)
        : options_{options}, plc_{options.is_slmp ? slmp_plc(options.family, options.is_3e_only,
                                                             options.is_udp, options.password)
                                                  : modbus_plc(options.units)}
    {
        for (const std::string& command : options.commands) {
            if (const std::string answer = execute(command); answer != "ok") {
                std::string reason = "--" + command;
                throw UsageError{reason.append(": ").append(answer)};
            }
        }
        asio::error_code error;
        const auto host = asio::ip::make_address(options.host, error);
        if (error) {
            throw UsageError{"--listen must begin with an IP address, not \"" + options.host + '"'};
        }
        std::uint16_t port = 0;
        if (options.is_udp) {
            asio::ip::udp::socket socket{context_, {host, options.port}};
            port = socket.local_endpoint().port();
            datagrams_ = std::make_unique<DatagramPort>(std::move(socket), *plc_);
        } else {
            acceptor_ = asio::ip::tcp::acceptor{context_, {host, options.port}};
            port = acceptor_.local_endpoint().port();
            accept();
        }
        std::printf(host.is_v6() ? "ready at [%s]:%u\n" : "ready at %s:%u\n", options.host.c_str(),
                    unsigned{port});
        std::fflush(stdout);
        signals_.async_wait([this](const asio::error_code&, int) { context_.stop(); });
        input_.assign(::dup(STDIN_FILENO));
        await_command();
        await_scan();
    }

    void run() { context_.run(); }

private:
    void accept()
    {
        acceptor_.async_accept([this](const asio::error_code& error, asio::ip::tcp::socket socket) {
            std::erase_if(sessions_, [](const auto& session) { return !session->is_open(); });
            if (!error && sessions_.size() < options_.max_connections) {
                asio::error_code ignored;
                socket.set_option(asio::ip::tcp::no_delay{true}, ignored);
                sessions_.push_back(std::make_shared<Session>(std::move(socket), plc_->connect()));
                sessions_.back()->advance();
            }
            accept();
        });
    }
    void await_command()
    {
        asio::async_read_until(input_, lines_, '\n',
                               [this](const asio::error_code& error, std::size_t) {
                                   if (error) {
                                       return; // without standard input it serves on
                                   }
                                   std::istream stream{&lines_};
                                   std::string line;
                                   std::getline(stream, line);
                                   std::printf("%s\n", execute(line).c_str());
                                   std::fflush(stdout);
                                   await_command();
                               });
    }
    void await_scan()
    {
        scan_.expires_after(std::chrono::milliseconds{100});
        scan_.async_wait([this](const asio::error_code&) {
            for (const std::string& address : counted_) {
                if (plc_->is_running()) {
                    plc_->set(address, static_cast<std::uint16_t>(*plc_->get(address) + 1));
                }
            }
            await_scan();
        });
    }

    std::string execute(const std::string& line)
    {
        std::istringstream words{line};
        std::string command;
        std::string first;
        std::string second;
        std::string third;
        words >> command >> first >> second >> third;
        const bool needs_place = command == "set" || command == "get" || command == "count";
        const auto present = needs_place ? plc_->get(first) : std::nullopt;
        if (needs_place && !present) {
            return "error: \"" + first + "\" is not an address of this PLC";
        }
        if (command == "get") {
            return std::to_string(*present);
        }
        return change(command, first, second, third)
                   ? "ok"
                   : "error: cannot do \"" + line + "\"; --help lists the commands";
    }
    bool change(const std::string& command, const std::string& first, const std::string& second,
                const std::string& third)
    {
        const auto number = number_of(command == "slow" ? first : second);
        if (command == "set") {
            return number && plc_->set(first, *number);
        }
        if (command == "count") {
            counted_.push_back(first);
            return true;
        }
        if (command == "refuse") {
            return (second.empty() || number) && plc_->refuse(first, number.value_or(0));
        }
        if (command == "label") {
            const auto bytes = bytes_of(third);
            return number && bytes &&
                   plc_->add_label(first, static_cast<std::uint8_t>(*number), *bytes);
        }
        if (command == "slow" && number) {
            set_latency(std::chrono::milliseconds{*number});
        } else if (command == "stop" || command == "run") {
            plc_->set_running(command == "run");
        } else if (command == "allow") {
            plc_->refuse_none();
        } else if (command == "close") {
            close();
        } else {
            return false;
        }
        return true;
    }
    void set_latency(busbar::Duration latency)
    {
        plc_->set_latency(latency);
        for (const auto& session : sessions_) {
            session->connection().set_latency(latency);
        }
    }
    void close()
    {
        for (const auto& session : std::exchange(sessions_, {})) {
            session->close();
        }
        if (datagrams_) {
            datagrams_->close();
        }
    }

    Options options_;
    std::unique_ptr<Plc> plc_;
    asio::io_context context_{1};
    asio::signal_set signals_{context_, SIGINT, SIGTERM};
    asio::ip::tcp::acceptor acceptor_{context_};
    std::vector<std::shared_ptr<Session>> sessions_{};
    std::unique_ptr<DatagramPort> datagrams_{};
    asio::posix::stream_descriptor input_{context_};
    asio::streambuf lines_{4096};
    asio::steady_timer scan_{context_};
    std::vector<std::string> counted_{};
};

int run(int argc, char** argv)
{
    Options options;
    CLI::App app{"A simulated PLC that clients of Modbus TCP or SLMP read and write: for tests of "
                 "what is to read a PLC, without one. All connections see the same memory."};
    add_options(app, options);
    busbar::command_line::add_program_options(app, "busbar-plc-responder");
    try {
        app.parse(argc, argv);
        Program{options}.run();
        return 0;
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? 0 : 2;
    } catch (const UsageError& error) {
        std::fprintf(stderr, "busbar-plc-responder: %s; --help shows the options\n", error.what());
        return 2;
    }
}

} // namespace

int main(int argc, char** argv)
{
    try {
        return run(argc, argv);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "busbar-plc-responder: cannot serve: %s\n", error.what());
        return 1;
    }
}
