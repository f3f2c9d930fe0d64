// Swarms as units, manifests and scripts: the command lines in them, and what a form cannot say.
#include "writers/command_lines.hpp"
#include "writers/needs.hpp"
#include "writers/yaml.hpp"

#include <hive/protocol/connect_text.hpp>
#include <hive/swarm_export.hpp>

#include <process.hpp>

#include <doctest/doctest.h>

#include <algorithm>

using namespace hive;
using hive::test::has;

namespace {

SwarmPlan doorway()
{
    const ConnectionOptions shared{.window = 2, .group = "camera", .lease = std::chrono::milliseconds(1500)};
    return {.name = "doorway",
            .drones = {{.name = "camera",
                        .kind = "camera",
                        .host = "user@cam1",
                        .set = {{"fps", 30}, {"source", "/dev/video0"}}},
                       {.name = "face-1", .kind = "face", .host = "gpu1", .restart = Restart::on_failure},
                       {.name = "face-2",
                        .kind = "face",
                        .host = "gpu1",
                        .restart = Restart::always,
                        .listen = "tcp://0.0.0.0:7700"},
                       {.name = "track", .kind = "track", .set = {{"title", "100% $HOME \"door\""}}, .halted = true}},
            .connections = {{{"camera", "image"}, {"face-1", "image"}, shared},
                            {{"camera", "image"}, {"face-2", ""}, shared},
                            {{"face-1", "faces"}, {"track", "in"}, {}}},
            .engines = {{"gpu*", {"slurm", {{"partition", "gpu"}, {"options", {"--gres=gpu:1"}}}}}}};
}

std::string joined(const std::vector<std::string>& words)
{
    std::string text;
    for (const auto& word : words)
        text += (text.empty() ? "" : " ") + word;
    return text;
}

std::string file_of(const std::vector<ExportedFile>& files, const std::string& name)
{
    const auto found = std::ranges::find(files, name, &ExportedFile::name);
    REQUIRE_MESSAGE(found != files.end(), name);
    return found->text;
}

}  // namespace

TEST_CASE("command lines: parameters, ports that receivers know, and connections")
{
    const auto plan = doorway();
    const CommandLines lines(plan, CommandLines::Machines::as_planned);
    CHECK_EQ(joined(lines.of(plan.drones[0])),
             "hive-camera --name camera --set fps=30 --set source=/dev/video0 --listen tcp://0.0.0.0:7700 "
             "--swarm doorway --expect image=face-1.image,group=camera");
    CHECK_EQ(joined(lines.of(plan.drones[1])), "hive-face --name face-1 --listen tcp://0.0.0.0:7701 "
                                               "--swarm doorway --expect faces=track.in --connect "
                                               "image=camera.image,at=tcp://cam1:7700,window=2,group=camera,lease=1.5");
    CHECK_EQ(joined(lines.of(plan.drones[2])),
             "hive-face --name face-2 --listen tcp://0.0.0.0:7700 --swarm doorway --connect "
             "camera.image,at=tcp://cam1:7700,window=2,group=camera,lease=1.5");
    CHECK_EQ(joined(lines.of(plan.drones[3])),
             "hive-track --name track --set title=100% $HOME \"door\" --halted --swarm doorway "
             "--connect in=face-1.faces,at=tcp://gpu1:7701");
}

TEST_CASE("command lines: on one machine drones meet without a port")
{
    SwarmPlan plan{.name = "s",
                   .drones = {{.name = "a", .kind = "edges.py"}, {.name = "b", .kind = "view"}},
                   .connections = {{{"a", "out"}, {"b", "in"}, {}}},
                   .engines = {}};
    const CommandLines lines(plan, CommandLines::Machines::as_planned);
    CHECK_EQ(joined(lines.of(plan.drones[0])), "python3 -u edges.py --name a --swarm s --expect out=b.in");
    CHECK_EQ(joined(lines.of(plan.drones[1])), "hive-view --name b --swarm s --connect in=a.out");
}

TEST_CASE("command lines: in containers each is found by its name")
{
    auto plan = doorway();
    plan.drones[1].key = "/home/user/key";
    const CommandLines lines(plan, CommandLines::Machines::one_each);
    CHECK_EQ(joined(lines.of(plan.drones[1])),
             "hive-face --name face-1 --listen tcp://0.0.0.0:7700 --advertise tcp://face-1:7700 "
             "--swarm doorway --expect faces=track.in --connect "
             "image=camera.image,at=tcp://camera:7700,window=2,group=camera,lease=1.5");
}

TEST_CASE("command lines: every connection is read as what the plan says")
{
    const auto plan = doorway();
    const CommandLines lines(plan, CommandLines::Machines::as_planned);
    for (const auto& connection : plan.connections) {
        const auto words = lines.of(*plan.drone(connection.to.drone));
        const auto read = protocol::connect_from_text(words.back());
        CHECK_EQ(read.drone, connection.from.drone);
        CHECK_EQ(read.output, connection.from.port);
        CHECK_EQ(read.input, connection.to.port);
        CHECK(read.options == connection.options);
    }
}

TEST_CASE("command lines: a sender that nobody finds, and an output that nobody knows")
{
    auto plan = doorway();
    plan.drones[0].host = Place::here;
    CHECK_THROWS_WITH_AS(CommandLines(plan, CommandLines::Machines::as_planned).of(plan.drones[1]),
                         "other machines need the address of camera", Error);
    plan.drones[0].advertise = "tcp://door.example";
    plan.drones[0].listen = "tcp://0.0.0.0";
    CHECK(has(joined(CommandLines(plan, CommandLines::Machines::as_planned).of(plan.drones[1])),
              "at=tcp://door.example:7700"));
    plan.connections[0].from.port.clear();
    CHECK_THROWS_WITH_AS(CommandLines(plan, CommandLines::Machines::as_planned).of(plan.drones[1]),
                         "which output of camera face-1 receives from is not known here", Error);
}

TEST_CASE("command lines: no two drones of a machine have one port, and there are only so many")
{
    SwarmPlan plan{.name = "s", .drones = {}, .connections = {}, .engines = {}};
    for (int i = 0; i < 2000; ++i)
        plan.drones.push_back({.name = "a" + std::to_string(i), .kind = "k", .host = "m"});
    const CommandLines lines(plan, CommandLines::Machines::as_planned);
    std::vector<std::string> listening;
    for (const auto& drone : plan.drones) {
        const auto words = lines.of(drone);
        listening.push_back(*std::next(std::ranges::find(words, "--listen")));
    }
    std::ranges::sort(listening);
    CHECK(std::ranges::adjacent_find(listening) == listening.end());
    plan.drones.push_back({.name = "one-more", .kind = "k", .host = "m"});
    CHECK_THROWS_AS(CommandLines(plan, CommandLines::Machines::as_planned), Error);
}

TEST_CASE("export: a text with a line end stays one word, in a unit of systemd and in a script")
{
    auto plan = doorway();
    plan.drones[3].set["title"] = "x\rExecStartPre=/bin/false\n\x1b[31m'";
    const auto unit = file_of(export_swarm(plan, "systemd", {}), "local/hive-doorway-track.service");
    CHECK_MESSAGE(has(unit, R"("title=x\x0dExecStartPre=/bin/false\n\x1b[31m'")"), unit);
    plan.engines.clear();
    const auto script = export_swarm(plan, "shell", {}).at(0).text;
    CHECK_MESSAGE(has(script, R"($'title=x\x0dExecStartPre=/bin/false\x0a\x1b[31m\'')"), script);
}

TEST_CASE("export: what a form cannot carry is said, and stands in the head of the first file")
{
    SwarmPlan plan{.name = "s",
                   .drones = {{.name = "p", .kind = "proj/tint.py"},
                              {.name = "q", .kind = "proj/tint.py"},
                              {.name = "r", .kind = "record", .host = "m", .set = {{"file", "/data/run.hive"}}},
                              {.name = "c", .kind = "camera", .set = {{"source", "/dev/video0"}}}},
                   .connections = {},
                   .engines = {}};
    using Notes = std::vector<std::string>;
    const std::string python = "p and 1 more need proj/tint.py, ", file = "r needs /data/run.hive, ";
    const std::string image = "which is not in the image: add it there, or as a volume";
    CHECK_EQ(export_notes(plan, "systemd"),
             Notes{python + "it has to be there, seen from the user's home directory", file + "it has to be on m"});
    CHECK_EQ(export_notes(plan, "shell"), Notes{file + "it has to be on m"});
    CHECK_EQ(export_notes(plan, "compose"),
             Notes{python + image, "r: runs on the machine of the containers, not on m",
                   file + "whose folder is mounted: it has to be there, with access for the user of the container"});
    CHECK_EQ(export_notes(plan, "kubernetes"),
             Notes{"p and 3 more: restarted after every exit, as with \"restart\": \"always\"", python + image,
                   file + "whose folder must be on m, where user 65532 needs access",
                   "c needs /dev/video0, which its privileged container gets from the node, if group 44 has access "
                   "there; name the node: \"on\""});
    for (const auto& form : export_forms())
        for (const auto& note : export_notes(plan, form))
            CHECK_MESSAGE(has(export_swarm(plan, form).at(0).text, "\n# " + note + ".\n"), form);
}

TEST_CASE("export: amounts, restarts and other engines that a form cannot carry are said")
{
    SwarmPlan plan{.name = "s",
                   .drones = {{.name = "a",
                               .kind = "k",
                               .host = "n1",
                               .restart = Restart::always,
                               .listen = "tcp://0.0.0.0:7701",
                               .key = "/k",
                               .cpus = 2,
                               .gpus = 1},
                              {.name = "b", .kind = "k", .host = "m1", .restart = Restart::always}},
                   .connections = {},
                   .engines = {{"n1", {"slurm", Json::object()}}}};
    using Notes = std::vector<std::string>;
    CHECK_EQ(export_notes(plan, "slurm"), Notes{"b: left out: the engine ssh starts it on m1"});
    CHECK_EQ(export_notes(plan, "systemd"), Notes{"a: gpus are not reserved"});
    CHECK_EQ(export_notes(plan, "kubernetes"),
             Notes{"a: has the key of the secret, not \"key\"", "a: listens at port 7700 for other containers only"});
    plan.engines.clear();
    CHECK_EQ(export_notes(plan, "shell"), Notes{"a and 1 more: never restarted",
                                                "a: cpus and memory_mib are not limited", "a: gpus are not reserved"});
    plan.drones[1].set["file"] = "x\n#SBATCH --wrap=id";
    plan.drones[1].kind = "x\nid.py";
    for (const auto& form : export_forms())
        for (const auto& written : export_swarm(plan, form))
            for (const char* line : {"\n#SBATCH --wrap", "\nid"})
                CHECK_FALSE_MESSAGE(has(written.text, line), written.text);
}

TEST_CASE("export: a plan with names, machines or options that would be lines of their own is refused")
{
    const auto refuses = [](const auto& change) {
        for (const auto& form : export_forms()) {
            auto plan = doorway();
            plan.engines = {{"gpu*", {"slurm", Json::object()}}};
            change(plan);
            CHECK_THROWS_AS_MESSAGE(export_swarm(plan, form), Error, form);
        }
    };
    refuses([](SwarmPlan& plan) { plan.name = "s\nid"; });
    refuses([](SwarmPlan& plan) { plan.drones[3].name = "s\nid"; });
    refuses([](SwarmPlan& plan) { plan.drones[3].host = "s\nid"; });
    refuses([](SwarmPlan& plan) { plan.engines[0].second.settings["partition"] = "p\nid"; });
    refuses([](SwarmPlan& plan) { plan.engines[0].second.settings["job"] = {"--time=1\nid"}; });
}

TEST_CASE("export: a form that there is not")
{
    CHECK_THROWS_WITH_AS(export_swarm(doorway(), "nomad"), "unknown export form \"nomad\"", Error);
    auto plan = doorway();
    plan.engines.clear();
    for (const auto& form : export_forms())
        CHECK_FALSE(export_swarm(plan, form).empty());
}

TEST_CASE("export: units of systemd, a folder for each machine")
{
    const auto files = export_swarm(doorway(), "systemd", {.programs = "/opt/hive/bin"});
    CHECK_EQ(files.size(), 7u);  // 3 targets, 4 services
    CHECK(has(file_of(files, "gpu1/hive-doorway.target"),
              "Wants=hive-doorway-face-1.service\nWants=hive-doorway-face-2.service\n"));
    CHECK(has(file_of(files, "gpu1/hive-doorway-face-1.service"), "Restart=on-failure\n"));
    CHECK(has(file_of(files, "gpu1/hive-doorway-face-1.service"), "\nType=notify\n"));
    CHECK(has(file_of(files, "local/hive-doorway-track.service"), "\nRestart=no\n"));
    CHECK(has(file_of(files, "gpu1/hive-doorway-face-1.service"), "\nAfter=network-online.target\n"));
    CHECK(has(file_of(files, "gpu1/hive-doorway-face-1.service"), "\nExecStart=/usr/bin/env hive-face --name face-1 "));
    CHECK(has(file_of(files, "local/hive-doorway-track.service"),
              "ExecStart=/opt/hive/bin/hive-track --name track --set \"title=100%% $$HOME \\\"door\\\"\" --halted "
              "--swarm doorway "));
}

TEST_CASE("export: a unit has limits, and a folder of programs with a space")
{
    auto plan = doorway();
    plan.drones[3].cpus = 2;
    plan.drones[3].memory_mib = 512;
    const auto unit =
        file_of(export_swarm(plan, "systemd", {.programs = "/opt/my $hive%\nx"}), "local/hive-doorway-track.service");
    CHECK_MESSAGE(has(unit, "\nCPUQuota=200%\nMemoryMax=512M\nExecStart=\"/opt/my $$hive%%\\nx/hive-track\" --name"),
                  unit);
}

TEST_CASE("export: folders of the paths in parameters, except those of the system")
{
    CHECK_EQ(folder_of("/data/run.hive"), "/data");
    CHECK_EQ(folder_of("/home/me/runs/x.hive"), "/home/me/runs");
    for (const char* path : {"/x.hive", "/usr/share/x.xml", "/etc/x", "/tmp/x.hive", "/dev/video0", "run.hive",
                             "./data/x", "/data/../etc/x", "//usr/lib/x", "", "http://x/y", "/data/a:b/x"})
        CHECK_MESSAGE(folder_of(path).empty(), path);
}

TEST_CASE("export: a text that looks like a path counts as one only if its parameter affects the machine")
{
    SwarmPlan plan;
    plan.name = "s";
    plan.drones = {{.name = "a", .kind = "say", .set = {{"text", "/runs/x"}, {"file", "/data/x"}}},
                   {.name = "b", .kind = "elsewhere", .set = {{"text", "/runs/x"}}},
                   {.name = "c", .kind = "say", .set = {{"text", "/runs/x"}}}};
    int asked = 0;
    const ExportOptions options{.interface_of = [&](const std::string& kind) {
        ++asked;
        if (kind != "say")
            throw Error(Errc::not_found, kind);
        Interface interface;
        ParameterInfo text, file;
        text.name = "text";
        file.name = "file";
        file.for_operator = true;
        interface.parameters = {text, file};
        return interface;
    }};
    const auto needs = needs_of(plan, options.interface_of);
    CHECK(asked == 2);
    CHECK(needs.at("a").folders == std::set<std::string>{"/data"});
    CHECK(needs.at("b").folders == std::set<std::string>{"/runs"});
    CHECK(needs.at("c").files.empty());
    const auto manifests = file_of(export_swarm(plan, "kubernetes", options), "s.yaml");
    CHECK(has(manifests.substr(0, manifests.find("\"s-b\"")), "StatefulSet"));
    CHECK(has(manifests.substr(manifests.find("\"s-c\"")), "Deployment"));
    CHECK_FALSE(has(manifests.substr(manifests.find("\"s-c\"")), "StatefulSet"));
    CHECK_FALSE(has(export_notes(plan, "kubernetes", options).back(), "c needs"));
}

TEST_CASE("export: a compose file with devices, folders, and what a drone needs")
{
    auto plan = doorway();
    plan.drones[0].set["certificate"] = "/data/a \"#$x\ny/cert";
    plan.drones[1].set = {{"source", "/dev/v4l/by-path/usb-0:1"}};
    plan.drones[1].cpus = 2;
    plan.drones[1].memory_mib = 512;
    plan.drones[1].gpus = 1;
    const auto text = file_of(export_swarm(plan, "compose"), "compose.yaml");
    CHECK(has(text,
              "    devices: [\"/dev/video0:/dev/video0\"]\n    group_add: [\"video\"]\n    volumes:\n      - type: "
              "\"bind\"\n        source: \"/data/a \\\"#$$x\\ny\"\n"));
    CHECK(has(text, "    cpus: 2\n    mem_limit: \"512m\"\n"));
    CHECK(has(text, "          devices:\n            - driver: \"nvidia\"\n              count: 1\n              "
                    "capabilities: [\"gpu\"]\n"));
    CHECK_FALSE(has(text, "by-path/usb-0:1:"));
    CHECK(has(text,
              "# face-1 needs /dev/v4l/by-path/usb-0:1, which cannot be in a container: use a path without ':'.\n"));
}

TEST_CASE("export: a compose file has the devices, and the key unless nobody needs it")
{
    auto plan = doorway();
    const auto text = file_of(export_swarm(plan, "compose", {.image = "registry/hive:1"}), "compose.yaml");
    CHECK(has(text, "    devices: [\"/dev/video0:/dev/video0\"]\n"));
    CHECK(has(text, "    image: \"registry/hive:1\"\n"));
    CHECK(has(text, "\"title=100% $$HOME \\\"door\\\"\""));
    CHECK(has(text, "secrets:\n  hive-key:\n    file: \"./swarm.key\"\n"));
    for (auto& drone : plan.drones)
        drone.insecure = true;
    plan.name = "Door.Way";  // a project has a lower-case name
    const auto insecure = file_of(export_swarm(plan, "compose"), "compose.yaml");
    CHECK_FALSE(has(insecure, "key"));
    CHECK(has(insecure, "docker-compose -p door-way up -d\n"));
}

TEST_CASE("export: containers with one that Prometheus scrapes")
{
    auto plan = doorway();
    plan.drones.resize(1);
    plan.connections.clear();
    const ExportOptions with_metrics{.metrics = true};
    const auto command = [](const std::string& host) {
        return R"(command: ["hivectl","metrics","--http","0.0.0.0:9464","--insecure","--place","camera=tcp://)" + host
               + ":7700\"]";
    };
    const auto compose = file_of(export_swarm(plan, "compose", with_metrics), "compose.yaml");
    CHECK(has(compose, "  hive-metrics:\n    image: \"hive:latest\"\n    " + command("camera")
                           + "\n    restart: \"always\"\n    user:"));
    const auto manifests = file_of(export_swarm(plan, "kubernetes", with_metrics), "doorway.yaml");
    CHECK(has(manifests, command("doorway-camera")));
    CHECK(has(manifests, "name: \"doorway-hive-metrics\""));
    CHECK(
        has(manifests, "annotations:\n        prometheus.io/scrape: \"true\"\n        prometheus.io/port: \"9464\"\n"));
    CHECK(has(manifests, "containerPort: 9464"));
    CHECK_THROWS_WITH_AS(export_swarm(plan, "systemd", with_metrics),
                         "only a swarm of containers is written with its metrics", Error);
    CHECK_FALSE(has(file_of(export_swarm(plan, "compose"), "compose.yaml"), "metrics"));
    plan.drones[0].name = "hive-metrics";
    CHECK_THROWS_AS(export_swarm(plan, "compose", with_metrics), Error);
}

TEST_CASE("export: manifests of Kubernetes, with names that it takes")
{
    auto plan = doorway();
    plan.drones[0].name = plan.connections[0].from.drone = plan.connections[1].from.drone = "Door_Cam";
    plan.connections[0].options.group = plan.connections[1].options.group = "Door_Cam";
    const auto files = export_swarm(plan, "kubernetes");
    const auto text = file_of(files, "doorway.yaml");
    CHECK(has(text, "kind: \"Service\"\nmetadata:\n  name: \"doorway-door-cam\"\n"));
    CHECK(has(text, "image=Door_Cam.image,at=tcp://doorway-door-cam:7700,window=2,group=Door_Cam,lease=1.5"));
    CHECK(has(text, "kind: \"Deployment\""));
    CHECK_FALSE(has(text, "kind: \"Job\""));  // its template cannot change
    CHECK(has(text, "kubernetes.io/hostname: \"gpu1\""));
    plan.connections.pop_back();
    plan.drones[3].name = "7th";
    CHECK(has(file_of(export_swarm(plan, "kubernetes"), "doorway.yaml"), "name: \"doorway-7th\""));
    plan.drones[3].name = "door.cam";
    CHECK_THROWS_WITH_AS(export_swarm(plan, "kubernetes"), "two drones would be called doorway-door-cam in Kubernetes",
                         Error);
    plan.drones[3].name = "door--cam";
    CHECK_THROWS_AS(export_swarm(plan, "kubernetes"), Error);
    plan.drones[3].name = std::string(45, 'x');
    CHECK_THROWS_AS(export_swarm(plan, "kubernetes"), Error);
    plan.drones[3].name = "track";
    plan.name = "7";
    CHECK_THROWS_AS(export_swarm(plan, "kubernetes"), Error);
    plan.name = std::string(40, 'x');
    CHECK_NOTHROW(export_swarm(plan, "kubernetes"));
    CHECK_THROWS_WITH_AS(export_swarm(plan, "kubernetes", {.metrics = true}),
                         doctest::Contains("-hive-metrics is not a valid Service name"), Error);
}

TEST_CASE("export: two swarms in one namespace of Kubernetes have no name in common")
{
    std::map<std::string, std::string> owners;
    for (const auto* swarm : {"a", "a-b", "a-b-c", "b"})
        for (const auto* drone : {"a", "b", "c", "b-c", "b--c", "b-c-d", "c-d", "c_", "d"}) {
            SwarmPlan plan;
            plan.name = swarm;
            plan.drones = {{.name = drone, .kind = "face"}};
            const auto text = file_of(export_swarm(plan, "kubernetes"), std::string(swarm) + ".yaml");
            const std::string key = "metadata:\n  name: ";
            const auto begin = text.find(key) + key.size();
            const auto name = text.substr(begin, text.find('\n', begin) - begin);
            const auto [owner, is_new] = owners.emplace(name, swarm);
            CHECK_MESSAGE(owner->second == swarm, name);
        }
    CHECK(owners.contains("\"a-b-c\""));
    CHECK(owners.contains("\"a-b--c\""));
}

TEST_CASE("export: a pod has its swarm's key, no rights, and what the drone needs")
{
    auto plan = doorway();
    plan.drones[1].set["file"] = "/data/#$x\n y/run.hive";
    plan.drones[3].set["file"] = "/runs/run.hive";
    plan.drones[3].cpus = 2;
    plan.drones[3].memory_mib = 512;
    plan.drones[3].gpus = 1;
    const auto files = export_swarm(plan, "kubernetes");
    const auto all = file_of(files, "doorway.yaml");
    const auto kustomization = file_of(files, "kustomization.yaml");
    CHECK(has(kustomization, "secretGenerator:\n  - name: \"doorway-key\"\n"));
    CHECK_FALSE(has(kustomization, "disableNameSuffixHash"));  // a new key gives new pods
    CHECK(has(all, "secret:\n            secretName: \"doorway-key\"\n            defaultMode: 288\n"));  // 0440
    CHECK(has(all, "runAsNonRoot: true\n"));
    CHECK(has(all, "fsGroup: 65532\n"));
    CHECK(has(all, "readinessProbe:\n"));

    const auto camera = all.substr(0, all.find("name: \"doorway-face-1\""));
    CHECK(has(camera, "privileged: true\n"));
    CHECK(has(camera, "supplementalGroups: [44]\n"));
    CHECK(has(camera, "hostPath:\n            path: \"/dev/video0\"\n            type: \"CharDevice\"\n"));
    const auto face = all.substr(all.find("name: \"doorway-face-1\""));
    CHECK(has(face, "hostPath:\n            path: \"/data/#$x\\n y\"\n            type: \"Directory\"\n"));
    const auto track = all.substr(all.find("kind: \"StatefulSet\""));
    CHECK(has(track, "mountPath: \"/runs\"\n"));
    CHECK(has(track, "volumeClaimTemplates:\n    - metadata:\n        name: \"data-0\"\n"));
    CHECK(has(track,
              "limits:\n              cpu: \"2\"\n              memory: \"512Mi\"\n              nvidia.com/gpu: "
              "\"1\"\n"));
    CHECK(has(track, "capabilities:\n              drop: [\"ALL\"]\n"));
}

TEST_CASE("export: a script for sbatch has the steps of the machines that Slurm has")
{
    const auto text = file_of(export_swarm(doorway(), "slurm"), "doorway.sbatch");
    CHECK(has(text, "#SBATCH --job-name=doorway\n#SBATCH --partition=gpu\n#SBATCH --gres=gpu:1\n#SBATCH "
                    "--nodes=1\n#SBATCH --nodelist=gpu1\n"));
    CHECK(has(text, "HIVE_HOME=$home-gpu1 keep on-failure srun --nodes=1 --ntasks=1 --job-name=face-1 "
                    "--nodelist=gpu1 --overlap hive-face "));
    CHECK_FALSE(has(text, "hive-camera"));
    CHECK(has(text, "# camera: left out: the engine ssh starts it on user@cam1.\n"));
}

TEST_CASE("export: a script for sbatch requests what the drones need, and gives it to their steps")
{
    auto plan = doorway();
    plan.engines = {{"gpu*", {"slurm", {{"options", {"--comment=a #b'$x\""}}, {"job", {"--time=60", "--requeue"}}}}},
                    {"cam1", {"slurm", {{"partition", "cameras"}}}}};
    plan.drones[0].host = "cam1";
    plan.drones[1].cpus = 2;
    plan.drones[1].memory_mib = 512;
    plan.drones[1].gpus = 1;
    const auto text = file_of(export_swarm(plan, "slurm"), "doorway.sbatch");
    CHECK_MESSAGE(has(text, "#SBATCH --partition=cameras\n#SBATCH --nodes=1\n#SBATCH --nodelist=cam1\n#SBATCH hetjob\n"
                            "#SBATCH --ntasks-per-node=1\n#SBATCH --cpus-per-task=3\n#SBATCH --mem=0\n"
                            "#SBATCH --gres=gpu:1\n#SBATCH \"--comment=a #b'$x\\\"\"\n#SBATCH --time=60\n"
                            "#SBATCH --requeue\n#SBATCH --nodes=1\n"),
                  text);
    CHECK_MESSAGE(has(text, "--job-name=face-1 --het-group=1 --nodelist=gpu1 --exact --cpus-per-task=2 --mem=512M "
                            "--gres=gpu:1 hive-face "),
                  text);
    CHECK_MESSAGE(has(text, "--job-name=face-2 --het-group=1 --nodelist=gpu1 --overlap --gres=none hive-face "), text);
    CHECK_MESSAGE(has(text, "--job-name=camera --het-group=0 --nodelist=cam1 --overlap hive-camera "), text);
    plan.drones[2].memory_mib = 256;
    plan.drones[2].gpus = 1;
    const auto more = file_of(export_swarm(plan, "slurm"), "doorway.sbatch");
    CHECK(has(more, "#SBATCH --mem=768M\n#SBATCH --gres=gpu:2\n"));
}

TEST_CASE("export: a script of hivectl")
{
    auto plan = doorway();
    CHECK_THROWS_WITH_AS(export_swarm(plan, "shell"), "face-1 is started by Slurm, which hivectl start does not do",
                         Error);
    plan.engines.clear();
    const auto text = file_of(export_swarm(plan, "shell"), "doorway.sh");
    CHECK(has(text, "hivectl start camera --as camera --on user@cam1 "));
    CHECK(has(text, " 'title=100% $HOME \"door\"' "));
    CHECK(has(text, "hivectl connect camera.image face-1.image --window 2 --group camera --lease 1.5\n"));
}

TEST_CASE("yaml: blocks, lists of objects, and texts in quotation marks")
{
    const OrderedJson value{
        {"a", "no"}, {"b", {1, "x: y"}}, {"c", {{{"d", 1}, {"e", OrderedJson::object()}}, {{"f", {{"g", true}}}}}}};
    CHECK_EQ(yaml_text({{"on", 1}, {"007", 2}, {"Null", 3}, {"a-1", 4}, {"1e3", 5}}),
             "\"on\": 1\n\"007\": 2\n\"Null\": 3\na-1: 4\n\"1e3\": 5\n");
    CHECK_EQ(yaml_text(value), "a: \"no\"\nb: [1,\"x: y\"]\nc:\n  - d: 1\n    e: {}\n  - f:\n      g: true\n");
}
