# Writes pytorch_network.npz, a small network of the reference's architecture as PyTorch saves it, and prints its value and
# derivatives at (0.48, 0.6, 0.64, 0.3) in double precision, which state_dict_test holds.
import pathlib

import numpy
import torch

softplus = torch.nn.functional.softplus


class Block(torch.nn.Module):
    def __init__(self, width):
        super().__init__()
        self.fc1 = torch.nn.Linear(width, width)
        self.fc2 = torch.nn.Linear(width, width)

    def forward(self, y):
        return softplus(self.fc2(softplus(self.fc1(y))) + y)


class Network(torch.nn.Module):
    def __init__(self, octaves=2, width=8, blocks=1):
        super().__init__()
        self.register_buffer("frequencies", 0.1 * 2.0 ** torch.arange(octaves))
        self.first = torch.nn.Linear(8 * octaves, width)
        self.blocks = torch.nn.ModuleList([Block(width) for _ in range(blocks)])
        self.last = torch.nn.Linear(width, 3)

    def embed(self, x):
        angles = (x[..., None] * self.frequencies).flatten(-2)
        return torch.cat([angles.sin(), angles.cos()], -1)

    def forward(self, x):
        y = softplus(self.first(torch.cat([self.embed(x[:, :3]), self.embed(x[:, 3:])], -1)))
        for block in self.blocks:
            y = block(y)
        return self.last(y)


def random_inputs(count):
    s = torch.nn.functional.normalize(torch.randn(count, 3), dim=1)
    return torch.cat([s, torch.rand(count, 1)], dim=1)


torch.manual_seed(7)
network = Network()
optimizer = torch.optim.RMSprop(network.parameters(), lr=1e-3, momentum=0.9)
for _ in range(200):
    x = random_inputs(256)
    loss = ((network(x) - x[:, :3] * (1 + x[:, 3:])) ** 2).mean()
    optimizer.zero_grad()
    loss.backward()
    optimizer.step()

inputs = random_inputs(8)
arrays = {name: value.numpy() for name, value in network.state_dict().items()}
arrays |= {"probe.inputs": inputs.numpy(), "probe.outputs": network(inputs).detach().numpy()}
numpy.savez(pathlib.Path(__file__).with_name("pytorch_network.npz"), **arrays)

network = network.double()
point = torch.tensor([[0.48, 0.6, 0.64, 0.3]], dtype=torch.float64)
print(network(point)[0].tolist())
print(torch.autograd.functional.jacobian(lambda x: network(x)[0], point)[:, 0, :].tolist())
