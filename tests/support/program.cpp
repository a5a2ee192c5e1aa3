#include "support/program.hpp"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <thread>

#include <fcntl.h>
#include <linux/capability.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

namespace busbar::test {

namespace {

namespace fs = std::filesystem;

std::string read_all(const std::string& path)
{
    std::ifstream file{path, std::ios::binary};
    return {std::istreambuf_iterator<char>{file}, {}};
}

/// In the child: nothing to read, everything that is printed into the file.
void redirect(const std::string& output_file)
{
    const int in = ::open("/dev/null", O_RDONLY);
    const int out = ::open(output_file.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    ::dup2(in, STDIN_FILENO);
    ::dup2(out, STDOUT_FILENO);
    ::dup2(out, STDERR_FILENO);
}

} // namespace

std::vector<std::string> variables_of(const Environment& environment, const Environment& defaults)
{
    const char* const path = std::getenv("PATH");
    Environment all{environment};
    all.insert(all.end(), defaults.begin(), defaults.end());
    all.emplace_back("PATH", path == nullptr ? "" : path);
    std::vector<std::string> variables;
    for (auto each = all.begin(); each != all.end(); ++each) {
        const auto has_name = [each](const auto& other) { return other.first == each->first; };
        if (std::none_of(all.begin(), each, has_name)) {
            variables.push_back(each->first + "=" + each->second);
        }
    }
    return variables;
}

std::vector<char*> pointers_to(std::vector<std::string>& texts)
{
    std::vector<char*> pointers;
    for (std::string& text : texts) {
        pointers.push_back(text.data());
    }
    pointers.push_back(nullptr);
    return pointers;
}

ScratchFolder::ScratchFolder()
{
    std::string pattern = (fs::temp_directory_path() / "busbar-test-XXXXXX").string();
    if (::mkdtemp(pattern.data()) == nullptr) {
        throw std::runtime_error{"there is no folder for the test"};
    }
    path_ = pattern;
}

ScratchFolder::~ScratchFolder()
{
    std::error_code ignored;
    fs::remove_all(path_, ignored);
}

std::string ScratchFolder::write(const std::string& name, std::string_view text) const
{
    const fs::path path = fs::path{path_} / name;
    fs::create_directories(path.parent_path());
    std::ofstream{path, std::ios::binary} << text;
    return path.string();
}

std::string ScratchFolder::read(const std::string& name) const
{
    return read_all(path_ + "/" + name);
}

Program::Program(std::vector<std::string> command, const std::string& folder,
                 const std::string& output_file, const Environment& environment)
    : output_file_{output_file}
{
    std::vector<std::string> variables = variables_of(environment);
    const std::vector<char*> arguments = pointers_to(command);
    const std::vector<char*> variable_list = pointers_to(variables);
    // What a program before it has printed is not this one's, not even until it begins.
    fs::remove(output_file);
    process_ = ::fork();
    if (process_ < 0) {
        throw std::runtime_error{"no process could be started"};
    }
    if (process_ == 0) {
        redirect(output_file);
        ::prctl(PR_CAPBSET_DROP, CAP_DAC_OVERRIDE);
        ::prctl(PR_CAPBSET_DROP, CAP_DAC_READ_SEARCH);
        if (::chdir(folder.c_str()) == 0) {
            ::execve(arguments[0], arguments.data(), variable_list.data());
        }
        ::perror(arguments[0]);
        ::_exit(127);
    }
}

Program::~Program()
{
    if (!has_ended()) {
        ::kill(process_, SIGKILL);
        ::waitpid(process_, nullptr, 0);
    }
}

std::string Program::output() const
{
    return read_all(output_file_);
}

bool Program::has_ended()
{
    int status = 0;
    if (!is_over_ && ::waitpid(process_, &status, WNOHANG) == process_) {
        is_over_ = true;
        status_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    }
    return is_over_;
}

std::string Program::end_text()
{
    if (!has_ended()) {
        return "runs";
    }
    return status_ > 128 ? "ended by signal " + std::to_string(status_ - 128)
                         : "ended with " + std::to_string(status_);
}

bool Program::wait_until(const std::function<bool()>& is_done)
{
    const auto end = std::chrono::steady_clock::now() + patience;
    while (!is_done()) {
        if (std::chrono::steady_clock::now() >= end) {
            return false;
        }
        std::this_thread::sleep_for(std::chrono::milliseconds{10});
    }
    return true;
}

bool Program::wait_for(std::string_view text)
{
    const auto is_there = [&] { return output().find(text) != std::string::npos; };
    return wait_until([&] { return is_there() || has_ended(); }) && is_there();
}

int Program::wait_for_end()
{
    static_cast<void>(wait_until([&] { return has_ended(); }));
    return status_;
}

} // namespace busbar::test
