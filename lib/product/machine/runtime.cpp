#include <busbar/product/runtime.hpp>

#include <busbar/backend/label_backend.hpp>
#include <busbar/controller/machine_settings.hpp>
#include <busbar/controller/published_program.hpp>

namespace busbar::product {

bool LoadedProgram::start(const Cycle&)
{
    return false;
}

void LoadedProgram::edited(const controller::ProgramAddition&) {}

void Runtime::begin(RuntimeHost&) {}

std::span<std::byte> Runtime::memory_of(const controller::GlobalVariable&)
{
    return {};
}

void Runtime::mode_changed(controller::MachineMode) {}

std::shared_ptr<backend::LabelBackend> Runtime::labels()
{
    return nullptr;
}

} // namespace busbar::product
