#include "label_simulation.hpp"

#include <algorithm>

namespace busbar::test {

using namespace std::chrono_literals;

namespace {

std::vector<std::int32_t> first_numbers(std::size_t clients)
{
    std::vector<std::int32_t> numbers;
    for (std::size_t i = 0; i < clients; ++i) {
        numbers.push_back(static_cast<std::int32_t>(i) * LabelBoard::step);
    }
    return numbers;
}

} // namespace

LabelWorldOptions LabelSimulation::world_options(const LabelSimulationOptions& options)
{
    LabelWorldOptions made;
    made.seed = options.seed;
    made.sampling = options.sampling;
    made.plc.programs.resize(2);
    made.plc.programs[0].target = "Count";
    made.plc.programs[1].target = "Twin";
    return made;
}

LabelSimulation::LabelSimulation(const LabelSimulationOptions& options)
    : chance_{options.seed, 1}, board_{first_numbers(options.clients)},
      plant_{"", variables(true), world_options(options)}, trace_{plant_.world().scheduler()},
      download_{plant_.world().scheduler(), [this] { download(); }},
      scan_end_{plant_.world().scheduler(), [this] { plant_.go_on_scanning(); }}
{
    plant_.world().network().weather().max_latency = 5ms;
    add_nodes();
    plant_.start();
    for (std::size_t i = 0; i < options.clients; ++i) {
        clients_.push_back(std::make_unique<LabelClient>(plant_.world(), board_, trace_, i,
                                                         Chance{options.seed, 100 + i}));
    }
    for (const auto& client : clients_) {
        client->start();
    }
}

void LabelSimulation::add_nodes()
{
    for (std::size_t i = 0; i < board_.variables(); ++i) {
        const std::uint32_t type = i == board_.mode_index() ? id::Int16 : id::Int32;
        plant_.add(board_.name(i), NodeId{0, type}, board_.name(i));
    }
}

std::string LabelSimulation::variables(bool has_mode)
{
    std::vector<std::string> declared;
    for (std::size_t i = 0; i < board_.written.size(); ++i) {
        declared.push_back(board_.name(i) +
                           " : DINT := " + std::to_string(first_numbers(i + 1).back()) + "; ");
    }
    declared.emplace_back("Count : DINT; ");
    declared.emplace_back("Twin : DINT; ");
    for (std::size_t i = chance_.below(8); i > 0; --i) {
        declared.push_back("Other" + std::to_string(i) + " : " +
                           chance_.pick({"INT", "LREAL", "STRING[9]", "BOOL"}) + "; ");
    }
    if (has_mode) {
        declared.push_back("Mode : " + std::string{chance_.pick({"INT", "DINT", "UINT", "UDINT"})} +
                           " := " + std::to_string(LabelBoard::mode) + "; ");
    }
    for (std::size_t i = declared.size(); i > 1; --i) {
        std::swap(declared[i - 1], declared[chance_.below(i)]);
    }
    std::string all;
    for (const std::string& one : declared) {
        all += one;
    }
    return all;
}

void LabelSimulation::download()
{
    ++downloads_;
    plant_.download("", variables(!chance_.one_in(5)));
    if (chance_.one_in(4)) { // a scan that takes long, in which names wait to be resolved
        plant_.stop_scans();
        scan_end_.set_after(chance_.between(20ms, 300ms));
    }
    // Now and then the next one comes before anybody has noticed this one.
    download_.set_after(chance_.one_in(4) ? chance_.between(1ms, 30ms) : chance_.between(50ms, 2s));
}

void LabelSimulation::run(std::chrono::seconds time)
{
    download_.set_after(100ms);
    plant_.world().run_for(time);
}

void LabelSimulation::finish()
{
    download_.cancel();
    for (const auto& client : clients_) {
        client->calm();
    }
    plant_.download("", variables(true));
    plant_.world().run_for(3s);
    for (const auto& client : clients_) {
        client->check_end();
    }
    for (const auto& client : clients_) {
        client->leave();
    }
}

} // namespace busbar::test
