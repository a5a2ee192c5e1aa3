// A simulated PLC that Modbus TCP or SLMP clients can read and write, for tests without a PLC.
// usage: busbar-plc-responder modbus|slmp [OPTIONS]; commands on standard input change it.
#include <charconv>
#include <cstdio>
#include <sstream>

#include <asio/io_context.hpp>
#include <asio/posix/stream_descriptor.hpp>
#include <asio/read_until.hpp>
#include <asio/signal_set.hpp>
#include <asio/streambuf.hpp>
#include <unistd.h>

#include "sockets.hpp"

using namespace plc_responder;

namespace {

constexpr const char* usage =
    "usage: busbar-plc-responder modbus|slmp [OPTIONS]\n"
    "  --listen HOST:PORT    default 127.0.0.1:0, a free port, which is printed\n"
    "  --udp                 SLMP over UDP instead of TCP\n"
    "  --plc iqr|q|fx5       family of the PLC with SLMP; q is a built-in port\n"
    "  --password TEXT       remote password that opens the port of a PLC with SLMP\n"
    "  --frame 3e|4e         3e: 4E frames of SLMP have no answer; 4e (default): both have\n"
    "  --units 1,2           units behind a Modbus gateway; default: every unit is this PLC\n"
    "  --connections COUNT   more are closed at once; default 64\n"
    "  --set ADDRESS=VALUE   as the command set; can be repeated, as the next three\n"
    "  --count ADDRESS       counts up ten times a second while the PLC is in RUN\n"
    "  --refuse ADDRESS      as the command refuse\n"
    "  --label NAME=TYPE:HEX as the command label\n"
    "  --delay MS            as the command slow\n"
    "  --stop                the PLC is in STOP\n"
    "commands on standard input:\n"
    "  set ADDRESS VALUE | get ADDRESS | count ADDRESS\n"
    "  refuse ADDRESS [CODE] | allow   refuse it, with an exception or end code | nothing more\n"
    "  label NAME TYPE HEX             adds an SLMP label: its type id, and its bytes\n"
    "  slow MS | stop | run            time of an answer | STOP | RUN\n"
    "  close                           ends all connections\n";

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
    /// Options that are commands, in their order.
    std::vector<std::string> commands{};
};

class UsageError : public std::runtime_error {
    using std::runtime_error::runtime_error;
};

std::uint16_t needed_number(std::string_view text, const std::string& what, std::uint16_t max)
{
    const auto number = number_of(text);
    if (!number || *number > max || text.starts_with('-')) {
        throw UsageError{what + " must be from 0 to " + std::to_string(max) + ", not \"" +
                         std::string{text} + '"'};
    }
    return *number;
}

/// Takes the value of an option, which is one of `names`.
std::size_t choice(std::string_view value, std::initializer_list<std::string_view> names,
                   const std::string& option)
{
    const auto* const found = std::find(names.begin(), names.end(), value);
    if (found == names.end()) {
        std::string known;
        for (const std::string_view name : names) {
            known.append(known.empty() ? "" : ", ").append(name);
        }
        throw UsageError{option + " must be one of " + known + ", not \"" + std::string{value} +
                         '"'};
    }
    return static_cast<std::size_t>(found - names.begin());
}

void take(Options& options, const std::string& option, std::string value)
{
    if (option == "--listen") {
        const std::size_t colon = value.rfind(':');
        if (colon == std::string::npos) {
            throw UsageError{"--listen must be HOST:PORT, not \"" + value + '"'};
        }
        options.port =
            needed_number(std::string_view{value}.substr(colon + 1), "the port", UINT16_MAX);
        const bool has_brackets = value.starts_with('[') && colon > 1;
        options.host = has_brackets ? value.substr(1, colon - 2) : value.substr(0, colon);
    } else if (option == "--plc") {
        options.family = static_cast<Family>(choice(value, {"iqr", "q", "fx5"}, option));
    } else if (option == "--password") {
        options.password = std::move(value);
    } else if (option == "--frame") {
        options.is_3e_only = choice(value, {"3e", "4e"}, option) == 0;
    } else if (option == "--units") {
        std::istringstream units{value};
        for (std::string unit; std::getline(units, unit, ',');) {
            options.units.push_back(
                static_cast<std::uint8_t>(needed_number(unit, "a unit", UINT8_MAX)));
        }
    } else if (option == "--connections") {
        options.max_connections = needed_number(value, option, UINT16_MAX);
    } else if (option == "--delay") {
        options.commands.push_back("slow " + value);
    } else if (option == "--set" || option == "--count" || option == "--refuse" ||
               option == "--label") {
        // "--label A=1:01" is the command "label A 1 01", but holding:0 has a colon of its own.
        const std::size_t equals = value.find('=');
        if (equals != std::string::npos) {
            std::replace(value.begin() + static_cast<std::ptrdiff_t>(equals), value.end(), ':',
                         ' ');
            value[equals] = ' ';
        }
        options.commands.push_back(option.substr(2) + ' ' + value);
    } else {
        throw UsageError{"unknown option " + option};
    }
}

Options options_of(const std::vector<std::string>& arguments)
{
    if (arguments.empty()) {
        throw UsageError{"the protocol, modbus or slmp, is missing"};
    }
    Options options;
    options.is_slmp = choice(arguments[0], {"modbus", "slmp"}, "the protocol") == 1;
    for (std::size_t i = 1; i < arguments.size(); ++i) {
        if (arguments[i] == "--udp") {
            options.is_udp = true;
        } else if (arguments[i] == "--stop") {
            options.commands.emplace_back("stop");
        } else if (i + 1 < arguments.size()) {
            take(options, arguments[i], arguments[i + 1]);
            ++i;
        } else {
            throw UsageError{arguments[i] + " is unknown, or has no value"};
        }
    }
    if (options.is_udp && !options.is_slmp) {
        throw UsageError{"--udp is for slmp"};
    }
    return options;
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
                throw UsageError{"--" + command + ": " + answer};
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

} // namespace

int main(int argc, char** argv)
{
    try {
        const std::vector<std::string> arguments{argv + 1, argv + argc};
        if (arguments.size() == 1 && arguments[0] == "--help") {
            std::fputs(usage, stdout);
            return 0;
        }
        Program{options_of(arguments)}.run();
        return 0;
    } catch (const UsageError& error) {
        std::fprintf(stderr, "busbar-plc-responder: %s; --help shows the options\n", error.what());
        return 2;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "busbar-plc-responder: cannot serve: %s\n", error.what());
        return 1;
    }
}
