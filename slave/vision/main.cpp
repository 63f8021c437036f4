// SPDX-License-Identifier: Apache-2.0
// telekerf-vision: the picture over the workpiece -> the contour, latched for everyone in the cell.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "common/bus/bus_flags.h"
#include "common/bus/endpoints.h"
#include "common/bus/event_answers.h"
#include "common/bus/process.h"
#include "common/geometry/polyline.h"
#include "common/robot/robot_model.h"
#include "common/runtime/loop.h"
#include "common/runtime/program.h"
#include "common/runtime/resources.h"
#include "common/runtime/say.h"
#include "common/runtime/startup_error.h"
#include "netem/drivers/netem_flags.h"
#include "netem/drivers/netem_switch.h"
#include "slave/vision/cameras/cameras.h"
#include "slave/vision/imaging_flags.h"
#include "slave/vision/run_recording.h"
#include "slave/vision/vision_node.h"

namespace telekerf::vision_process {
namespace {

constexpr std::chrono::milliseconds kReport{1000};
constexpr std::chrono::milliseconds kImagingReport{200};  ///< a focus is watched while it is sought
constexpr std::chrono::milliseconds kPreview{100};        ///< between two of a live picture, at least

struct Flags {
  BusFlags bus;
  netem::NetemFlags netem;
  std::string image = "heart";
  std::string camera = "none";
  vision::ExtractionMode mode = vision::ExtractionMode::kAuto;
  vision::AnchorMode anchor = vision::AnchorMode::kBoundingBox;
  vision::PictureFlags picture;
  ImagingFlags imaging;
  int select = 0;
  double width_mm = 0.0;
  bool fit_all = false;
  double join_mm = 0.01;
  std::optional<double> dpi;
  vision::LengthUnit units = vision::LengthUnit::kFile;
  std::vector<std::string> layers;
  std::vector<std::string> colours;
  std::string robot = "slave-keops";
  std::string master_robot = "master-horizontal";
  double master_beta = 0.5;
  RecordFlags record;
  std::string config;
};

ContourRequest request_of(const Flags& flags) {
  ContourRequest request;
  request.image = flags.image;
  request.mode = flags.mode;
  request.anchor = flags.anchor;
  request.picture = flags.picture;
  request.select = static_cast<std::size_t>(flags.select);
  if (flags.width_mm > 0.0) request.width_m = flags.width_mm * 1e-3;
  request.fit_all = flags.fit_all;
  request.drawing.join_m = 1e-3 * flags.join_mm;
  request.drawing.dpi = flags.dpi;
  request.drawing.unit_m = vision::metres_of(flags.units);
  request.drawing.layers = flags.layers;
  request.drawing.colours = flags.colours;
  request.workspace_radius_m = robot::load_robot(flags.robot).workspace.radius_m;
  if (flags.master_beta > 0.0) {
    request.hand_radius_m = flags.master_beta * robot::load_robot(flags.master_robot).workspace.radius_m;
  }
  return request;
}

/// A shipped picture's name is that picture, even beside a folder of results that is called the same.
std::string path_of(const std::string& image) {
  const std::vector<std::string> shipped = shipped_names("pictures", ".png");
  const bool named = std::find(shipped.begin(), shipped.end(), image) != shipped.end();
  return std::filesystem::is_directory(image) && !named ? image
                                                        : find_resource("pictures", image, ".png").string();
}

void say(const ContourMessage& contour, StatusReporter& status) {
  const geometry::Polyline line{contour.points_m, contour.closed};
  const Vec2 size = geometry::bounding_box(line.points_m).size() * 1e3;
  // A drawing has a size of its own, no pixels.
  const std::string scale = contour.metres_per_pixel > 0.0
                                ? fmt::format(", {:.4f} mm a pixel", contour.metres_per_pixel * 1e3)
                                : "";
  status.say(fmt::format("{} ({}): {} points, {:.1f} mm long, {:.1f} x {:.1f} mm{}", contour.source,
                         contour.mode, contour.points_m.size(), geometry::length_m(line) * 1e3, size.x(),
                         size.y(), scale));
  if (!contour.further.empty()) status.say(fmt::format("{} further contours", contour.further.size()));
}

/// What the cell says: to the imaging unit, if there is one, and of what is meant in the picture.
VisionNode::Outcome obey(Reader<EventMessage>& events, EventAnswers& answers, ImagingCamera* unit,
                         VisionNode& node, RunRecording& recording) {
  VisionNode::Outcome outcome;
  while (const auto event = events.take()) {
    const EventMessage& said = event->value;
    const bool looks = said.kind == EventMessage::Kind::kLook;
    const bool adjusts = said.kind == EventMessage::Kind::kSetZoom || said.kind == EventMessage::Kind::kRefocus;
    if (looks || adjusts) recording.heard(said, node.record().tick);
    if (looks) {
      auto looked = node.look(said.text);
      answers.give(said.epoch, looked ? "" : looked.error());
      if (looked) outcome = std::move(*looked);
      continue;
    }
    if (!adjusts) continue;
    const std::string refused =
        unit != nullptr ? unit->refusal() : "there is no imaging unit; start vision with --imaging";
    if (refused.empty()) said.kind == EventMessage::Kind::kSetZoom ? unit->zoom(said.value) : unit->refocus();
    answers.give(said.epoch, refused);
  }
  answers.again();
  return outcome;
}

/// What the camera shows, as often as somebody can see it: with each contour, and of a live one in between.
class Preview {
 public:
  explicit Preview(Bus& bus) : writer_(bus) {}
  void step(const VisionNode& node, bool news, bool live) {
    const auto now = std::chrono::steady_clock::now();
    if (!news && (!live || writer_.readers() == 0 || now < next_)) return;
    next_ = now + kPreview;
    if (const auto preview = node.preview()) writer_.write(*preview);
  }

 private:
  Writer<PreviewMessage> writer_;
  std::chrono::steady_clock::time_point next_;
};

TelemetryMessage values_of(const VisionNode& node, const ImagingCamera* unit, std::chrono::duration<double> unseen) {
  TelemetryMessage values = node.record();
  values.values.emplace_back("look_age_s", unseen.count());
  if (unit != nullptr) {
    const auto more = unit->values();
    values.values.insert(values.values.end(), more.begin(), more.end());
  }
  return values;
}

int run(Flags& flags) {
  flags.record.validate("vision");
  if (!flags.imaging.calibrate.empty()) {
    run_calibration(flags.imaging, flags.camera);
    return 0;
  }
  const bool live = flags.camera != "none" || flags.imaging.wanted();
  std::unique_ptr<ImagingCamera> unit;
  if (flags.imaging.wanted())
    unit = open_imaging(flags.imaging, path_of(flags.image), 1e-3 * flags.width_mm, flags.camera);
  std::unique_ptr<Camera> plain;
  if (!unit) plain = live ? open_camera(flags.camera) : open_image(path_of(flags.image));
  Camera* const camera = unit ? unit.get() : plain.get();
  VisionNode node(request_of(flags));
  Camera::Result seen = camera->next();
  VisionNode::Outcome outcome = node.step(seen);
  // A file's first look decides; what lies under a camera may come later.
  if (!live && node.state() == VisionNode::State::kNoContour) throw input_error(outcome.remark);

  BusSettings settings = flags.bus.bus_settings(Site::kSlave, "vision");
  const auto emulator = flags.netem.emulator(settings.site);
  settings.receive_filter = emulator;
  Process process(settings, "vision");
  if (const std::string warning = flags.imaging.warning(); !warning.empty()) process.status().say(warning);
  const netem::NetemSwitch netem_switch(process.bus(), emulator);
  Writer<ContourMessage> writer(process.bus());
  Writer<TelemetryMessage> telemetry(process.bus());
  Reader<EventMessage> events(process.bus());
  EventAnswers answers(process.bus());
  Preview preview(process.bus());
  RunRecording recording(flags.record,
                         flags.netem.with_network(run_identity(settings, "telekerf-vision", flags.config)),
                         values_of(node, unit.get(), {}), process.status());
  auto report_at = std::chrono::steady_clock::now();
  auto looked = report_at;  // when it was last seen where it is
  while (!stop_requested() && !process.ended()) {
    process.alive();
    if (seen && *seen && node.confirms()) looked = std::chrono::steady_clock::now();
    if (!outcome.remark.empty()) write_line(stderr, "vision: " + outcome.remark);
    if (outcome.publish) {
      writer.write(*outcome.publish);
      recording.published(*outcome.publish);
      say(*outcome.publish, process.status());
    }
    preview.step(node, outcome.publish.has_value(), seen && *seen && (*seen)->settles);
    if (const auto now = std::chrono::steady_clock::now(); now >= report_at) {
      const TelemetryMessage values = values_of(node, unit.get(), now - looked);
      telemetry.write(values);
      recording.values(values);
      report_at = now + (unit ? kImagingReport : kReport);
    }
    const VisionNode::Outcome meant = obey(events, answers, unit.get(), node, recording);
    if (unit) {
      if (const std::string remark = unit->remark(); !remark.empty()) process.status().say(remark);
    }
    // A live camera sets the pace; for files and for what is gone, now and then will do.
    const bool more = unit || (seen && *seen && (*seen)->settles);
    std::this_thread::sleep_for(std::chrono::milliseconds(more ? 1 : 200));
    seen = camera->next();
    outcome = node.step(seen);
    if (meant.publish && !outcome.publish) outcome.publish = meant.publish;
  }
  recording.close();
  process.refuse_ended();
  recording.refuse_unfinished();
  return 0;
}

void add_parameters(Flags& flags, Settings& settings) {
  settings.add("image", flags.image, kPicture,
               "a shipped picture's name, a picture, SVG or DXF file, a folder of them, or a video");
  settings.add("camera", flags.camera,
               device_form("none, N, " + camera_forms(),
                           [](const std::string& camera) {
                             return camera == "none" ? std::string() : validate_camera(camera);
                           }),
               "what shows the workpiece in place of image; N: a /dev/video device");
  flags.imaging.add_parameters(settings);
  settings.add("mode", flags.mode, vision::kExtractionModes, "from pixels to points");
  flags.picture.add_parameters(settings);
  settings.add("anchor", flags.anchor, vision::kAnchorModes, "what lies on the workpiece's origin");
  settings.add("select", flags.select, {.min = 0, .max = 9999}, "which contour, 0 is the largest");
  settings.add("width_mm", flags.width_mm, {.min = 0, .max = 10000, .unit = "mm"},
               "width of the whole picture; 0: the contour is fitted to 60 % of the slave's workspace, and "
               "to beta x the "
               "operator's");
  settings.add("fit_all", flags.fit_all,
               "all contours together are centred and fitted, not the longest alone");
  settings.add("join_mm", flags.join_mm, {.min = 0, .max = 10, .unit = "mm"},
               "ends of a drawing's lines as near as this are joined");
  settings.add("dpi", flags.dpi, {.min = 1, .max = 100000, .unit = "pixels an inch"},
               "of a scan, or of an SVG file in pixels; without it: what the file says");
  settings.add("units", flags.units, vision::kLengthUnits, "a unit of an SVG or DXF file");
  settings.add("layers", flags.layers, TextForm{"NAME"}, "these layers of a drawing alone, with those within them");
  settings.add("colours", flags.colours, TextForm{"COLOUR"},
               "these colours of a drawing alone: #rrggbb, a name, or a DXF number");
  settings.add("robot", flags.robot, kRobot, "the slave's robot: a shipped name or a file");
  settings.add("master_robot", flags.master_robot, kRobot, "the operator's, for the size alone");
  settings.add("master_beta", flags.master_beta, {.min = 0, .max = 10},
               "slave motion = beta x master motion, for the size alone; 0: no operator");
  flags.record.add_parameters(settings);
  flags.bus.add_parameters(settings);
  flags.netem.add_parameters(settings);
}

}  // namespace
}  // namespace telekerf::vision_process

int main(int argc, char** argv) {
  using namespace telekerf::vision_process;
  return telekerf::run_program(argc, argv, "telekerf-vision",
                               "Finds the contour in a picture and publishes it", Flags{}, add_parameters,
                               run);
}
