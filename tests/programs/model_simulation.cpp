#include "programs/model_simulation.hpp"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <utility>

#include <busbar/controller/mapping_extensions.hpp>
#include <busbar/controller/project.hpp>

namespace busbar::test {

namespace {

std::string variable(const std::string& name, const char* data_type, const std::string& content)
{
    return "<UAVariable NodeId=\"ns=1;s=" + name + "\" BrowseName=\"1:" + name + "\" DataType=\"" +
           data_type + "\" AccessLevel=\"3\"><DisplayName>" + name +
           "</DisplayName><References><Reference ReferenceType=\"i=40\">i=63</Reference>"
           "<Reference ReferenceType=\"i=35\" IsForward=\"false\">i=85</Reference></References>" +
           content + "</UAVariable>\n";
}

std::string model(int number, const std::string& label)
{
    return std::string{"<UANodeSet xmlns=\"http://opcfoundation.org/UA/2011/03/UANodeSet.xsd\">\n"
                       "<NamespaceUris><Uri>"} +
           simulated_model + "</Uri></NamespaceUris>\n<Models><Model ModelUri=\"" +
           simulated_model + "\" Version=\"1\"/></Models>\n" +
           variable("Number", "i=6",
                    "<Value><Int32 xmlns=\"http://opcfoundation.org/UA/2008/02/Types.xsd\">" +
                        std::to_string(number) + "</Int32></Value>") +
           variable("Mapped", "i=4",
                    "<Extensions><Extension xmlns=\"" + std::string{controller::mapping_namespace} +
                        "\"><DataMapping Data=\"" + label + "\"/></Extension></Extensions>") +
           "</UANodeSet>\n";
}

} // namespace

std::string simulated_project(int number, const std::string& port, const std::string& label)
{
    controller::Project project;
    auto& listener = project.network.listeners.front();
    listener.address = "127.0.0.1";
    listener.port = static_cast<std::uint32_t>(std::stoul(port));
    project.security.policies = {"Basic256Sha256"};
    project.security.mode = MessageSecurityMode::SignAndEncrypt;
    project.models.push_back({"Simulation.xml", model(number, label)});
    return controller::document_of(project).value();
}

ModelSimulation::ModelSimulation(std::uint64_t seed) : chance_{seed, 3}
{
    const product::Configuration configuration{.file = site_.file,
                                               .project = (site_.folder.path / "project").string()};
    controller_ = std::make_unique<ForkedController>(configuration, site_.log().string());
    chief_ = std::make_unique<ControllerAdministrator>(
        site_.ports, (site_.folder.path / "client").string(), ControllerSite::password);
    expected_ = {Projects{}};
    start();
    check();
    site_.keep_own_certificate();
}

void ModelSimulation::run(std::size_t steps)
{
    for (std::size_t i = 0; i < steps && violations_.empty(); ++i) {
        arm();
        act();
        if (!violations_.empty()) {
            break;
        }
        if (!controller_->is_running() || chance_.one_in(2)) {
            power_cycle();
        }
        check();
    }
    if (violations_.empty()) {
        power_cycle();
        check();
    }
    chief_->disconnect();
}

std::string ModelSimulation::story() const
{
    std::string all;
    for (const std::string& line : story_) {
        all += line + "\n";
    }
    return all + "the controller's log:\n" + read_all(site_.log());
}

void ModelSimulation::note(const std::string& what)
{
    story_.push_back(what);
    std::ofstream{site_.log(), std::ios::app} << "# " << what << "\n";
    if (std::getenv("BUSBAR_SIMULATION_TRACE") != nullptr) {
        std::fprintf(stderr, "%s\n", what.c_str());
    }
}

void ModelSimulation::violation(const std::string& what)
{
    note("VIOLATION: " + what);
    violations_.push_back(what);
}

// The power.

void ModelSimulation::arm()
{
    if (is_armed_) {
        return;
    }
    if (const auto fault = controller_->draw_fault(chance_)) {
        note(fault->text);
        is_armed_ = true;
        is_failing_ = fault->is_of_media;
        is_kept_ = false;
    }
}

void ModelSimulation::power_cycle()
{
    note(controller_->is_running() ? "the power goes" : "it was killed");
    chief_->disconnect();
    controller_->kill();
    controller_->calm();
    if (chance_.one_in(6)) {
        controller_->orders().killed_at = controller_->orders().calls + chance_.below(25);
        note("is to be killed soon after its start");
        if (controller_->start() == ForkedController::Start::Serves) {
            // What it takes up it keeps, or is killed before that.
            perhaps([this](Projects& all) { take_up(all, all.kept); });
        }
        controller_->kill();
        controller_->calm();
    }
    start();
}

void ModelSimulation::start()
{
    ++counts_.starts;
    is_armed_ = false;
    is_failing_ = false;
    is_kept_ = false;
    if (controller_->start() != ForkedController::Start::Serves) {
        return violation("it does not start: " + controller_->why_not());
    }
    for (Projects& all : expected_) {
        take_up(all, all.kept);
    }
    forget_duplicates();
}

bool ModelSimulation::counts(const Projects& all, int last) const
{
    return all.stored != damaged &&
           (all.stored == none || last == none || all.stored == last ||
            all.stored == all.accepted || versions_.at(all.stored).is_usable);
}

void ModelSimulation::take_up(Projects& all, int last) const
{
    all.served = counts(all, last) ? all.stored : last;
    all.kept = all.served;
}

std::string ModelSimulation::port_of(int number) const
{
    return number == none ? site_.settings.at("port") : versions_.at(number).port;
}

// What happens.

void ModelSimulation::act()
{
    switch (chance_.below(16)) {
    case 0:
        return write_wrong();
    case 1:
    case 2:
    case 3:
    case 4:
        return update(false);
    case 5:
        return update(true);
    case 6:
    case 7:
        return restart();
    case 8:
        return reload();
    case 9:
    case 10:
        return damage();
    default:
        return write();
    }
}

int ModelSimulation::new_version()
{
    const int number = site_.next_number();
    const bool is_usable = !chance_.one_in(4);
    const std::string& port = site_.ports[chance_.one_in(3) ? 1 : 0];
    versions_[number] = {simulated_project(number, port, is_usable ? "Speed" : "Missing"), port,
                         is_usable};
    return number;
}

void ModelSimulation::write()
{
    const int number = new_version();
    const std::string what = "write " + std::to_string(number) + " with the port " +
                             versions_[number].port +
                             (versions_[number].is_usable ? "" : " and a label that is missing");
    const Outcome outcome = chief_->project("write", versions_[number].document);
    counts_.written += outcome == Outcome::Done ? 1 : 0;
    follow(outcome, what, [number](Projects& all) { all.stored = number; });
}

void ModelSimulation::write_wrong()
{
    std::string wrong = simulated_project(site_.next_number(), site_.ports.front(), "Speed");
    wrong[chance_.below(wrong.size())] ^= 1;
    const Outcome outcome = chief_->project("write", wrong);
    if (outcome == Outcome::Done) {
        violation("a damaged project was taken");
    }
    follow(outcome, "write a damaged project", [](Projects&) {});
}

void ModelSimulation::update(bool despite_labels)
{
    const Outcome outcome =
        chief_->project(despite_labels ? "update despite labels" : "update", {});
    const auto is_possible = [&](const Projects& all) {
        return all.stored > none && (despite_labels || versions_.at(all.stored).is_usable);
    };
    if (outcome == Outcome::Done && std::ranges::none_of(expected_, is_possible)) {
        return violation("a project whose labels are missing counts");
    }
    if (outcome == Outcome::Done) {
        ++counts_.updated;
        std::erase_if(expected_, [&](const auto& all) { return !is_possible(all); });
    }
    const Change accept = [this, despite_labels](Projects& all) {
        if (despite_labels && all.stored > none && !versions_.at(all.stored).is_usable) {
            all.accepted = all.stored;
        }
    };
    follow(outcome, despite_labels ? "update despite labels" : "update", accept);
    if (is_failing_ && outcome == Outcome::Refused) {
        perhaps(accept); // this was kept, and all else could not be
    }
    if (outcome == Outcome::Refused) {
        return;
    }
    wait_for_effect();
    // It takes place after the answer: a power cut or media may come between.
    const Change take = [&](Projects& all) {
        if (is_possible(all)) {
            all.served = all.kept = all.stored;
        }
    };
    if (is_armed_ || outcome == Outcome::Unknown) {
        perhaps(take);
    } else {
        std::ranges::for_each(expected_, take);
    }
    if (is_failing_) {
        perhaps([](Projects& all) { all.served = all.stored; }); // and cannot be kept
    }
}

void ModelSimulation::restart()
{
    const Outcome outcome = chief_->restart();
    note(outcome == Outcome::Done ? "restart: done" : "restart: not done, " + chief_->why_not());
    chief_->disconnect();
    if (outcome == Outcome::Refused) {
        return;
    }
    wait_for_effect();
    perhaps([this](Projects& all) { take_up(all, all.served); });
    if (is_failing_) {
        perhaps([this](Projects& all) {
            if (counts(all, all.served)) {
                all.served = all.stored;
            }
        });
    }
}

/// Whatever is there to be read again, the project is not.
void ModelSimulation::reload()
{
    note("is to read again");
    controller_->hang_up();
}

/// Of the project's file, while it does not run.
void ModelSimulation::damage()
{
    if (!is_kept_ || is_armed_ || expected_.front().stored == none) {
        return;
    }
    chief_->disconnect();
    controller_->kill();
    const fs::path file = site_.folder.path / "project/project/project.busbar";
    std::string content = read_all(file);
    if (content.empty()) {
        return violation("there is no file of the project");
    }
    if (chance_.one_in(2)) {
        content.resize(content.size() / 2);
    } else {
        content[chance_.below(content.size())] ^= 1;
    }
    std::ofstream{file, std::ios::binary} << content;
    note("damaged: " + file.string());
    for (Projects& all : expected_) {
        all.stored = damaged;
    }
    start();
}

void ModelSimulation::follow(Outcome outcome, const std::string& what, const Change& change)
{
    if (outcome == Outcome::Done) {
        note(what + ": done");
        std::ranges::for_each(expected_, change);
    } else if (outcome == Outcome::Refused) {
        ++counts_.refused;
        note(what + ": refused, " + chief_->why_not());
    } else {
        ++counts_.unknown;
        note(what + ": no answer, " + chief_->why_not());
        perhaps(change);
    }
    if (outcome == Outcome::Refused && is_failing_) {
        perhaps(change); // it may be there although this could not be found out
    }
    forget_duplicates();
}

void ModelSimulation::perhaps(const Change& change)
{
    const std::vector<Projects> before = expected_;
    std::ranges::for_each(expected_, change);
    expected_.insert(expected_.end(), before.begin(), before.end());
    forget_duplicates();
}

void ModelSimulation::forget_duplicates()
{
    std::vector<Projects> all;
    for (const Projects& each : std::exchange(expected_, {})) {
        if (std::ranges::find(all, each) == all.end()) {
            all.push_back(each);
        }
    }
    expected_ = std::move(all);
}

/// Until it serves what is in the store, or has said why not.
void ModelSimulation::wait_for_effect()
{
    constexpr int most = 50;
    const auto refusals = [this] {
        const std::string log = read_all(site_.log());
        return log.rfind("nothing was changed");
    };
    const auto before = refusals();
    for (int i = 0; i < most && controller_->is_running() && refusals() == before; ++i) {
        const auto report =
            chief_->project_report("nsu=" + std::string{simulated_model} + ";s=Number");
        if (report && report->state == "in use") {
            return;
        }
    }
}

std::string ModelSimulation::mismatch(const Projects& expected,
                                      const ControllerAdministrator::ProjectReport& report) const
{
    const int served = report.number.value_or(none);
    if (served != expected.served) {
        return "it serves " + std::to_string(served) + " instead of " +
               std::to_string(expected.served);
    }
    if (chief_->port() != port_of(expected.served)) {
        return "it listens on " + chief_->port() + " instead of " + port_of(expected.served);
    }
    const int told = expected.stored == damaged ? expected.served : expected.stored;
    const std::string document = told == none ? std::string{} : versions_.at(told).document;
    if (report.document != document) {
        return "its store does not have " + std::to_string(expected.stored);
    }
    const std::string state = expected.stored == damaged           ? "damaged"
                              : expected.stored == none            ? "none"
                              : expected.stored == expected.served ? "in use"
                                                                   : "written";
    return report.state.starts_with(state) ? std::string{}
                                           : "it says \"" + report.state + "\", not " + state;
}

void ModelSimulation::check()
{
    if (!violations_.empty() || (is_armed_ && !controller_->is_running())) {
        return;
    }
    constexpr int most = 20;
    std::optional<ControllerAdministrator::ProjectReport> report;
    for (int i = 0; i < most && !report && controller_->is_running(); ++i) {
        report = chief_->project_report("nsu=" + std::string{simulated_model} + ";s=Number");
    }
    if (!report) {
        if (!is_armed_) {
            violation("it does not answer: " + chief_->why_not());
        }
        return;
    }
    std::string why_not;
    std::vector<Projects> right;
    for (const Projects& each : expected_) {
        const std::string wrong = mismatch(each, *report);
        if (wrong.empty()) {
            right.push_back(each);
        } else {
            why_not += "\n  " + wrong;
        }
    }
    if (right.empty()) {
        return violation("it is otherwise than expected:" + why_not);
    }
    expected_ = std::move(right);
    is_kept_ = is_kept_ || !is_armed_;
}

} // namespace busbar::test
