#include "own_controller.hpp"

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <fstream>
#include <new>
#include <span>
#include <sstream>
#include <system_error>
#include <thread>
#include <utility>

#include <fcntl.h>
#include <netinet/in.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <busbar/controller/plc_task.hpp>
#include <busbar/crypto/password_hash.hpp>
#include <busbar/crypto/random.hpp>
#include <busbar/net/system.hpp>

#include "identity.hpp"
#include "mapped/mapped_model.hpp"
#include "own_server.hpp"
#include "process.hpp"
#include "product/life/start.hpp"
#include "product/machine/simulated_runtime.hpp"

namespace busbar::bench {

namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

constexpr std::string_view output_file = "output";

/// Cheap enough for a program that is slowed down by a sanitizer.
constexpr crypto::PasswordCost quick_cost{.scheme = crypto::PasswordScheme::Pbkdf2,
                                          .iterations = 10'000};

constexpr std::string_view quick_logins = R"(
[limits]
login_failures_per_address = 1000
first_login_delay_ms = 0
max_login_delay_ms = 0
[users]
password_hash = "pbkdf2"
password_iterations = 10000
)";

/// Guessers and those who mean well have one address here, and would be locked out together.
constexpr std::string_view usual_logins = R"(
[limits]
login_failures_per_address = 1000
[users]
)";

constexpr std::string_view machine_table = R"([machine]
name = "Controller"
mode = "PROGRAM"
state = "state"
medium = "medium"
execution_log = true
)";

/// Which nobody listens at; 0 if there is none.
std::uint16_t free_port()
{
    const int handle = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    auto* const any = reinterpret_cast<sockaddr*>(&address);
    const bool is_bound = ::bind(handle, any, size) == 0 && ::getsockname(handle, any, &size) == 0;
    ::close(handle);
    return is_bound ? ntohs(address.sin_port) : std::uint16_t{0};
}

bool write_file(const fs::path& path, std::span<const std::byte> bytes)
{
    std::ofstream file{path, std::ios::binary};
    file.write(reinterpret_cast<const char*>(bytes.data()),
               static_cast<std::streamsize>(bytes.size()));
    return file.good();
}

bool write_file(const fs::path& path, const std::string& text)
{
    return write_file(path, std::as_bytes(std::span{text}));
}

std::string read_file(const fs::path& path)
{
    std::ostringstream text;
    text << std::ifstream{path}.rdbuf();
    return text.str();
}

/// Tables of the configuration.
std::string accounts(bool has_quick_logins)
{
    crypto::SystemRandom random;
    const auto hash = crypto::hash_password(good_password, random,
                                            has_quick_logins ? quick_cost : crypto::PasswordCost{});
    std::ostringstream text;
    text << (has_quick_logins ? quick_logins : usual_logins) << "anonymous = \"read\"\n";
    for (const std::string_view role : administration_roles) {
        text << "[[users.account]]\nname = \"" << role << "\"\npassword = \"" << hash.value_or("")
             << "\"\nroles = [\"" << role << "\"]\n";
    }
    return text.str();
}

/// Measures pieces of the controller's work: what its thread had of a processor between two turns.
/// Once a millisecond another thread asks for a turn.
class PieceMeter {
public:
    PieceMeter(product::RunningController& controller, std::atomic<double>& longest_ms)
        : thread_{[this, &controller, &longest_ms] {
              while (!is_over_) {
                  controller.post([this, &longest_ms] { turn(longest_ms); });
                  std::this_thread::sleep_for(1ms);
              }
          }}
    {
    }
    PieceMeter(const PieceMeter&) = delete;
    PieceMeter& operator=(const PieceMeter&) = delete;
    ~PieceMeter()
    {
        is_over_ = true;
        thread_.join();
    }

private:
    void turn(std::atomic<double>& longest_ms)
    {
        const double now = thread_time_ms();
        if (last_ >= 0 && now - last_ > longest_ms) {
            longest_ms = now - last_;
        }
        last_ = now;
    }

    std::atomic<bool> is_over_{false};
    double last_{-1};
    std::thread thread_;
};

/// As busbar-controller does, with what it does measured.
int serve(const std::string& file, bool is_model, std::atomic<double>& longest_ms)
{
    try {
        product::Configuration configuration;
        configuration.file = file;
        configuration.project = is_model ? "project" : "";
        product::SimulatedRuntime runtime;
        controller::ThreadMaker threads;
        net::StderrLog log{LogLevel::Debug};
        bool starts = true;
        while (starts) {
            const auto controller = product::start(configuration, runtime, log, {}, threads);
            const PieceMeter meter{*controller, longest_ms};
            starts = controller->run();
        }
        return 0;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "busbar-bench: %s\n", error.what());
        return 1;
    }
}

void redirect_output(const std::string& file)
{
    const int handle = ::open(file.c_str(), O_WRONLY | O_CREAT | O_APPEND, 0600);
    ::dup2(handle, STDOUT_FILENO);
    ::dup2(handle, STDERR_FILENO);
    ::close(handle);
    ::close(STDIN_FILENO);
    static_cast<void>(::setsid()); // a terminal's end is none of its business
}

} // namespace

struct OwnController::Shared {
    std::atomic<double> longest_ms{0};
};

OwnController::OwnController(std::string folder, channel::ApplicationIdentity client,
                             Shared* shared, OwnControllerOptions options)
    : folder_{std::move(folder)}, client_{std::move(client)}, shared_{shared}, options_{std::move(
                                                                                   options)}
{
}

Result<std::unique_ptr<OwnController>> OwnController::start(const OwnControllerOptions& options)
{
    auto client = make_identity(net::SystemWallClock{}.now());
    std::string folder = (fs::temp_directory_path() / "busbar-bench-XXXXXX").string();
    if (!client || ::mkdtemp(folder.data()) == nullptr) {
        return fail(status::Bad_ResourceUnavailable);
    }
    void* const memory =
        ::mmap(nullptr, sizeof(Shared), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (memory == MAP_FAILED) {
        return fail(status::Bad_OutOfMemory);
    }
    std::unique_ptr<OwnController> controller{
        new OwnController{std::move(folder), *std::move(client), new (memory) Shared, options}};
    if (!controller->begin()) {
        controller->keep_folder();
        return fail(status::Bad_CommunicationError);
    }
    return controller;
}

bool OwnController::begin()
{
    const std::uint16_t port = free_port();
    url_ = "opc.tcp://127.0.0.1:" + std::to_string(port);
    if (port == 0 || !write_files(port)) {
        return false;
    }
    const std::string file = folder_ + "/controller.toml";
    const std::string program =
        options_.program.empty() ? "" : fs::absolute(options_.program).string();
    process_ = ::fork();
    if (process_ != 0) {
        return process_ > 0 && await();
    }
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    redirect_output(folder_ + "/" + std::string{output_file});
    static_cast<void>(::chdir(folder_.c_str()));
    if (program.empty()) {
        ::_exit(serve(file, options_.is_model, shared_->longest_ms));
    }
    ::execl(program.c_str(), program.c_str(), "--config", file.c_str(), nullptr);
    ::_exit(127);
}

bool OwnController::write_files(std::uint16_t port) const
{
    std::ostringstream text;
    text << "[server]\nname = \"Bench\"\naddress = \"127.0.0.1\"\nauditing = true\nport = " << port
         << "\n[certificates]\nfolder = \"pki\"\n"
         << (options_.trusts_all_clients ? "trust_all_clients = true\n" : "")
         << "[[endpoint]]\npolicy = \"None\"\nmode = \"None\"\n"
         << "[[endpoint]]\npolicy = \"Basic256Sha256\"\nmode = \"SignAndEncrypt\"\n"
         << accounts(options_.has_quick_logins)
         << "[[files]]\nname = \"recipes\"\nfolder = \"recipes\"\n"
         << (options_.is_model ? "[labels]\n" : machine_table) << "program = \"" << program_file
         << "\"\n";
    const fs::path folder{folder_};
    std::error_code failed;
    fs::create_directories(folder / "pki/trusted/certs", failed);
    fs::create_directories(folder / "recipes", failed);
    return !failed && write_file(folder / "controller.toml", text.str()) &&
           write_file(folder / "recipes/press.csv", std::string(1'000, 'x')) &&
           write_file(folder / "pki/trusted/certs/bench.der", client_.certificates.front().der()) &&
           write_program(0);
}

bool OwnController::write_program(std::size_t number, std::string_view file) const
{
    std::ostringstream text;
    text << "{attribute 'publish' := 'publish only'}\nVAR_GLOBAL\n    Speed : INT := 17;\n"
         << "    Text : STRING[32] := 'bench';\n    List : ARRAY [0..9] OF LREAL;\n";
    for (std::size_t i = 0; i < options_.variables; ++i) {
        if (options_.is_model) {
            text << "    " << mapped_name(i) << " : INT;\n";
        } else {
            text << "    Bulk" << i << " : DINT;\n";
        }
    }
    for (std::size_t i = 0; i < number % 8; ++i) {
        text << "    Added" << i << " : " << (number % 16 < 8 ? "DINT" : "LREAL") << ";\n";
    }
    text << "END_VAR\nVAR_GLOBAL RETAIN\n    Kept : DINT := 5;\nEND_VAR\n";
    return write_file(fs::path{folder_} / file, text.str());
}

bool OwnController::write_project(std::string_view file, const std::string& name) const
{
    MappedModel model;
    model.objects = options_.variables / model.variables;
    controller::Project project;
    project.network.listeners.front().port =
        static_cast<std::uint32_t>(std::stoul(url_.substr(url_.rfind(':') + 1)));
    project.security.policies.clear();
    project.security.mode = MessageSecurityMode::None;
    project.security.allows_anonymous = true;
    project.certificate.server_name = name;
    project.models = model_files(model);
    const auto document = controller::document_of(project);
    return document && write_file(fs::path{folder_} / file, *document);
}

bool OwnController::await()
{
    for (int i = 0; i < 6'000 && is_running(); ++i) {
        if (output().find("\nready") != std::string::npos || output().starts_with("ready")) {
            return true;
        }
        std::this_thread::sleep_for(20ms);
    }
    return false;
}

double OwnController::take_longest_piece_ms()
{
    return shared_->longest_ms.exchange(0);
}

void OwnController::reload() const
{
    ::kill(process_, SIGHUP);
}

bool OwnController::is_running()
{
    int result = 0;
    if (!exit_code_ && ::waitpid(process_, &result, WNOHANG) == process_) {
        exit_code_ = WIFEXITED(result) ? WEXITSTATUS(result) : 128 + WTERMSIG(result);
    }
    return process_ > 0 && !exit_code_;
}

int OwnController::stop()
{
    if (is_running()) {
        ::kill(process_, SIGTERM);
    }
    for (int i = 0; i < 3'000 && is_running(); ++i) {
        std::this_thread::sleep_for(20ms);
    }
    if (is_running()) {
        ::kill(process_, SIGKILL);
        while (is_running()) {
            std::this_thread::sleep_for(20ms);
        }
    }
    return exit_code_.value_or(1);
}

std::string OwnController::output() const
{
    return read_file(fs::path{folder_} / output_file);
}

OwnController::~OwnController()
{
    if (is_running()) {
        ::kill(process_, SIGKILL);
        ::waitpid(process_, nullptr, 0);
    }
    ::munmap(shared_, sizeof(Shared));
    if (!keeps_folder_) {
        std::error_code ignored;
        fs::remove_all(folder_, ignored);
    }
}

} // namespace busbar::bench
